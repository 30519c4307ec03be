#include "server/reference/gauss_seidel.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "server/model/spring_gains.h"
#include "server/reference/contacts.h"
#include "server/reference/strain_limit.h"
#include "server/reference/sweeps.h"

namespace clothlab::reference {

namespace {

using Vectors = std::vector<dvec3>;

/// How much of gravity a vertex fell with in the step before (Chen et al. 2024, section 3.7): none at rest,
/// so that a cloth at rest starts where it stays; all of it in free fall, in air too. Nearly all counts as
/// all, for the sake of float32.
dvec3 felt_gravity(const dvec3& gravity, const dvec3& acceleration) {
  const double squared = glm::dot(gravity, gravity);
  if (!(squared > 0.0)) return dvec3(0.0);
  return gravity * std::clamp(1.02 * glm::dot(acceleration, gravity) / squared, 0.0, 1.0);
}

SweepState begin(const World& world, const State& state, double t, double t_next) {
  const std::size_t count = state.position.size();
  const double dt = world.scene.solver.dt, drag = model::mobility(world.scene);
  const dvec3& gravity = world.scene.gravity;
  SweepState step{world,
                  t,
                  dt,
                  state.position,
                  state.velocity,
                  Vectors(count),
                  Vectors(count),
                  Vectors(count, dvec3(0.0)),
                  std::vector<double>(count),
                  Vectors(world.model.springs.size(), dvec3(0.0)),
                  std::vector<int>(count, 0),
                  state.contacts};
  step.contacts.resize(count, 0);
  Vectors end = state.position, unused(count);
  place_pins(world, t_next, end, unused);
  const bool guesses = world.scene.solver.method == scene::Method::vbd && !state.velocity_before.empty();
  for (std::uint32_t i = 0; i < count; ++i) {
    const dvec3& v = state.velocity[i];
    step.mobility[i] = drag * inverse_mass(world, i);
    step.displacement[i] = step.free[i] =
        world.pinned(i) ? end[i] - state.position[i] : drag * (dt * v + dt * dt * gravity);
    if (guesses && !world.pinned(i))
      step.displacement[i] =
          drag * (dt * v + dt * dt * felt_gravity(gravity, (v / drag - state.velocity_before[i]) / dt));
  }
  return step;
}

/// The velocity of a vertex that the step's free motion brings to a surface faster than it could fall to it
/// in a step or two: turned back by the surface's restitution.
dvec3 bounced(const SweepState& step, std::uint32_t i, const dvec3& v) {
  dvec3 stopped = step.x[i] + step.free[i];
  Surface met;
  if (stop_on_way(step.world, step.t, step.x[i], stopped, met) == 0 || !(met.restitution > 0.0)) return v;
  const double approach = glm::dot(met.velocity - step.v[i], met.normal);
  if (!(approach > 2.0 * step.dt * glm::length(step.world.scene.gravity))) return v;
  return v + met.normal * (met.restitution * approach - glm::dot(v - met.velocity, met.normal));
}

}  // namespace

void gauss_seidel_step(const World& world, State& state, double t, double t_next) {
  const scene::Scene& scene = world.scene;
  const bool by_vertices = scene.solver.method == scene::Method::vbd;
  const bool passes = scene.self_collision || (!by_vertices && !scene.colliders.empty());
  SweepState step = begin(world, state, t, t_next);
  for (int n = 0; n < scene.solver.iterations; ++n) {
    by_vertices ? sweep_vertices(step) : sweep_springs(step);
    if (passes) contact_pass(step);
  }

  State next;
  next.step = state.step + 1;
  next.contacts = step.contacts;
  if (by_vertices) next.velocity_before = state.velocity;
  for (std::uint32_t i = 0; i < step.x.size(); ++i) {
    next.position.push_back(step.now(i));
    next.velocity.push_back(bounced(step, i, step.displacement[i] / step.dt));
  }
  place_pins(world, t_next, next.position, next.velocity);
  limit_strain(world, next);
  state = std::move(next);
}

}  // namespace clothlab::reference
