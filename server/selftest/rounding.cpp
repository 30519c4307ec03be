#include "server/selftest/rounding.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "server/reference/trajectory.h"
#include "server/reference/wind.h"
#include "server/scene/method.h"
#include "server/sim/colliders.h"

namespace clothlab::selftest {

namespace {

using glm::dvec3;

constexpr double unit_roundoff = 0x1p-24;  // of float32, round to nearest
// Roundings are as good as independent: n of them add up to sqrt(n) of one (Higham and Mary, A New Approach
// to Probabilistic Rounding Error Analysis, 2019).
/// From places to a force an element takes at most 32 operations one after another, each rounded once (GLSL
/// 4.5, section 4.7.1: a division 2.5 times, a square root as much as both).
const double of_a_force = std::sqrt(32.0);
/// A vertex's displacement by an element in a sweep is a share of the element's length: differences, a
/// length, a direction and a product.
const double of_a_visit = std::sqrt(16.0);
/// Standard deviations that a device may be away.
constexpr double surely = 10.0;
constexpr int disturbed_runs = 4;

struct Sums {
  std::vector<double> force;   ///< [vertex_count] what the rounding of forces is a share of [N]
  std::vector<double> length;  ///< [vertex_count] the same of displacements [m]
  std::vector<double>
      stiffness;  ///< [vertex_count] of the elements at a vertex, with what damping adds [N/m]
};

Sums sums_at(const reference::World& world, const reference::State& state) {
  const std::size_t count = state.position.size();
  Sums sums{std::vector<double>(count, 0.0), std::vector<double>(count, 0.0),
            std::vector<double>(count, 0.0)};
  model::each_element(world.model.elements, [&](const auto& element) {
    double length = 0.0, speed = 0.0;
    for (const std::uint32_t vertex : element.vertices) {
      const std::uint32_t first = element.vertices[0];
      length = std::max(length, glm::distance(state.position[first], state.position[vertex]));
      speed = std::max(speed, glm::distance(state.velocity[first], state.velocity[vertex]));
    }
    const double stiffness = element_stiffness(element.law), damping = element_damping(element.law),
                 force = stiffness * length + damping * speed;
    for (const std::uint32_t vertex : element.vertices) {
      sums.force[vertex] += force * force;
      sums.length[vertex] += length * length;
      sums.stiffness[vertex] += stiffness + damping / world.scene.solver.dt;
    }
  });
  for (std::size_t i = 0; i < count; ++i) {
    sums.force[i] = std::sqrt(sums.force[i]);
    sums.length[i] = std::sqrt(sums.length[i]);
  }
  return sums;
}

/// A random number of at most `most` either way.
dvec3 within(double most, std::mt19937& random) {
  const auto either = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  const double x = either(), y = either(), z = either();
  return most * dvec3(x, y, z);
}

}  // namespace

Rounding step_rounding(const reference::World& world, const reference::State& before,
                       const reference::State& after) {
  const scene::Solver& solver = world.scene.solver;
  const std::size_t count = before.position.size();
  const Sums sums = sums_at(world, before);
  std::vector<dvec3> wind(count, dvec3(0.0));
  reference::add_wind(world, before.position, before.velocity, static_cast<double>(before.step) * solver.dt,
                      wind);
  double fastest = 0.0;
  for (const dvec3& velocity : after.velocity) fastest = std::max(fastest, glm::length(velocity));
  const bool touches = !world.scene.colliders.empty() || world.scene.self_collision;
  Rounding bound{std::vector<double>(count), std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const double x = glm::length(before.position[i]) + glm::length(after.position[i]);
    const double v = glm::length(before.velocity[i]) + glm::length(after.velocity[i]);
    // An implicit method resists an error of a force as it resists the force.
    const double resisting = world.model.mass[i] +
                             (scene::solves(solver.method) ? solver.dt * solver.dt * sums.stiffness[i] : 0.0);
    const double field = glm::length(world.scene.gravity) + world.scene.air_drag * v + glm::length(wind[i]);
    const double evaluations = std::sqrt(static_cast<double>(scene::facts(solver.method).evaluations));
    double velocity =
        unit_roundoff * (v + solver.dt * of_a_force * (evaluations * sums.force[i] / resisting + field));
    if (scene::sweeps(solver.method))
      velocity = unit_roundoff * (v + (x + of_a_visit * sums.length[i]) / solver.dt);
    // A solve ends when its residual is this share of the largest momentum.
    if (scene::solves(solver.method)) velocity += solver.tolerance * fastest;
    bound.velocity[i] = velocity;
    // A surface is made of numbers of about a metre, in float32.
    bound.position[i] = solver.dt * velocity + unit_roundoff * (x + (touches ? x + 4.0 : 0.0));
  }
  return bound;
}

void disturb(const reference::World& world, const Rounding& rounding, unsigned seed,
             reference::State& state) {
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const dvec3 place = within(rounding.position[i], random), velocity = within(rounding.velocity[i], random);
    if (world.pinned(i)) continue;
    state.position[i] += place;
    state.velocity[i] += velocity;
    if (!state.half_velocity.empty()) state.half_velocity[i] += velocity;
  }
}

double allowed_distance(const reference::World& world, const reference::State& end, int steps) {
  double largest = 0.0;
  for (unsigned run = 0; run < disturbed_runs; ++run) {
    reference::State state = reference::at_rest(world);
    for (int n = 0; n < steps; ++n) {
      const reference::State before = state;
      reference::step(world, state);
      disturb(world, step_rounding(world, before, state),
              run * static_cast<unsigned>(steps) + static_cast<unsigned>(n), state);
    }
    largest = std::max(largest, reference::rms_distance(state.position, end.position));
  }
  return surely * largest;
}

double allowed_distance(const reference::World& world, sim::Simulation& simulation, const sim::State& end,
                        int steps) {
  const reference::State start = reference::at_rest(world), last = in_double(end);
  const Rounding rounding = step_rounding(world, start, last);
  double largest = 0.0;
  for (const double bound : rounding.position) largest = std::max(largest, bound);
  for (unsigned run = 0; run < disturbed_runs; ++run) {
    reference::State disturbed = start;
    disturb(world, rounding, run, disturbed);
    simulation.restore({{disturbed.position.begin(), disturbed.position.end()},
                        {disturbed.velocity.begin(), disturbed.velocity.end()}},
                       0.0, 0);
    simulation.step(static_cast<std::uint32_t>(steps));
    const reference::State found = in_double(simulation.read_state());
    largest = std::max(largest, reference::rms_distance(found.position, last.position));
  }
  return surely * std::sqrt(static_cast<double>(steps)) * largest;
}

reference::State in_double(const sim::State& state) {
  reference::State result;
  result.position.assign(state.position.begin(), state.position.end());
  result.velocity.assign(state.velocity.begin(), state.velocity.end());
  result.contacts.assign(state.position.size(), 0);
  return result;
}

Result<reference::World> world_of(const scene::Scene& scene) {
  const Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  return reference::make_world(scene, sim::contact_margins(scene, *model));
}

}  // namespace clothlab::selftest
