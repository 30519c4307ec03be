#include "server/reference/gauss_seidel.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "server/model/constraint_gains.h"
#include "server/reference/contacts.h"
#include "server/reference/strain_limit.h"
#include "server/reference/sweeps.h"
#include "server/reference/vectors.h"
#include "server/reference/wind.h"
#include "server/scene/method.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

/// Whether a vertex fell freely in the step before, as in shaders/methods/vertex_descent.glsl: 1 if its
/// acceleration was `pull` [m/s^2] but for two hundredths, 0 if but for a tenth or more. So a cloth at rest
/// starts its step where it stays.
double falls(const dvec3& acceleration, const dvec3& pull) {
  const double size = glm::length(pull);
  return size > 0.0 ? std::clamp((0.1 - glm::distance(acceleration, pull) / size) / 0.08, 0.0, 1.0) : 1.0;
}

/// True if a vertex with velocity v hits the surface in an impact: it approaches faster than gravity alone
/// could make it in two steps.
bool hits(const SweepState& step, const Surface& met, const dvec3& v) {
  return glm::dot(met.velocity - v, met.normal) > 2.0 * step.dt * glm::length(step.world.scene.gravity);
}

/// The displacement from which VBD's sweeps start [m]: inertia's displacement, and gravity's and the wind's
/// where the vertex falls freely. Where the free motion meets a collider, the surface and friction cut both
/// down.
dvec3 first_guess(const SweepState& step, std::uint32_t i, const std::optional<dvec3>& velocity_before) {
  const World& world = step.world;
  const double dt = step.dt, drag = model::mobility(world.scene);
  const dvec3 &v = step.v[i], free = step.free_displacement[i] + step.blown[i];
  dvec3 pull = world.scene.gravity + step.blown[i] / (drag * dt * dt), felt(0.0);
  if (velocity_before) felt = (v / drag - *velocity_before) / dt;
  const auto not_followed = [&] {
    return velocity_before ? (1.0 - falls(felt, pull)) * drag * dt * dt * pull : dvec3(0.0);
  };
  dvec3 stopped = step.x[i] + free;
  Surface met;
  if (stop_at_colliders_position(world, step.t, i, step.x[i], stopped, met) == 0)
    return free - not_followed();
  const dvec3& n = met.normal;
  const double depth = glm::dot(stopped - (step.x[i] + free), n);
  const dvec3 on_surface = free + n * depth, carried = dt * met.velocity;
  pull -= n * glm::dot(pull, n);
  felt -= n * glm::dot(felt, n);
  felt += elements::friction_displacement(on_surface - carried, n, met.friction, depth) / (drag * dt * dt);
  const dvec3 moved = on_surface - not_followed();
  return moved - elements::friction_displacement(moved - carried, n, met.friction, depth);
}

/// The velocities at this step's start that the next step compares its own with; none at a vertex that hits a
/// collider.
std::vector<std::optional<dvec3>> velocities_to_keep(const SweepState& step) {
  std::vector<std::optional<dvec3>> before(step.v.begin(), step.v.end());
  for (std::uint32_t i = 0; i < before.size(); ++i) {
    dvec3 stopped = step.x[i] + step.free_displacement[i] + step.blown[i];
    Surface met;
    if (stop_at_colliders_position(step.world, step.t, i, step.x[i], stopped, met) > 0 &&
        hits(step, met, step.v[i]))
      before[i].reset();
  }
  return before;
}

/// Sets what the wind at the step's end adds. To PBD and XPBD it is a force, as in an explicit step. To VBD
/// its force on a vertex is f - braking (u - v), with u the velocity at the step's end, as in implicit Euler:
/// what is added is then the solution of m (1 + dt drag) (u - u_0) = dt (f - braking (u - v)), with u_0 the
/// velocity without wind.
void blow(SweepState& step, double t_next) {
  const World& world = step.world;
  const double dt = step.dt, air_drag = 1.0 / model::mobility(world.scene);
  const bool by_vertices = scene::sweeps_vertices(world.scene.solver.method);
  Vectors gained(step.x.size(), dvec3(0.0));
  add_wind(world, step.x, step.v, t_next, gained);
  const std::vector<elements::WindLoad> loads = wind_loads(world, step.x, step.v, t_next);
  for (std::uint32_t i = 0; i < step.x.size(); ++i) {
    if (world.pinned(i)) continue;
    if (!by_vertices) {
      step.blown[i] = dt * dt / air_drag * gained[i];
      continue;
    }
    const double inertia = world.model.mass[i] * air_drag;
    step.added_inertia[i] = dt * loads[i].braking;
    const dvec3 without = (step.v[i] + dt * world.scene.gravity) / air_drag;
    step.blown[i] = dt * (dt * loads[i].force + step.added_inertia[i] * (step.v[i] - without)) /
                    (inertia + step.added_inertia[i]);
  }
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
                  std::vector<double>(count, 0.0),
                  Vectors(count, dvec3(0.0)),
                  std::vector<double>(count),
                  {},
                  std::vector<int>(count, 0),
                  state.contacts};
  step.contacts.resize(count, 0);
  world.model.elements.each_swept([&]<class Law>(const model::Batch<Law>& batch) {
    std::get<Pushes<Law>>(step.pushed).resize(batch.size());
  });
  Vectors end = state.position, unused(count);
  place_pins(world, t_next, end, unused);
  const bool guesses = scene::sweeps_vertices(world.scene.solver.method);
  if (world.scene.wind) blow(step, t_next);
  for (std::uint32_t i = 0; i < count; ++i) {
    const dvec3& v = state.velocity[i];
    step.mobility[i] = drag * inverse_mass(world, i);
    step.displacement[i] = step.free_displacement[i] =
        world.pinned(i) ? end[i] - state.position[i] : drag * (dt * v + dt * dt * gravity);
    step.displacement[i] += step.blown[i];
    if (guesses && !world.pinned(i))
      step.displacement[i] =
          first_guess(step, i, state.velocity_before.empty() ? std::nullopt : state.velocity_before[i]);
  }
  return step;
}

/// The velocity of vertex i after the step: v, but if its free motion hits a surface in an impact, with the
/// normal part turned back by the surface's restitution.
dvec3 bounced(const SweepState& step, std::uint32_t i, const dvec3& v) {
  dvec3 stopped = step.x[i] + step.free_displacement[i];
  Surface met;
  if (stop_at_colliders_position(step.world, step.t, i, step.x[i], stopped, met) == 0 ||
      !(met.restitution > 0.0))
    return v;
  if (!hits(step, met, step.v[i])) return v;
  const double approach = glm::dot(met.velocity - step.v[i], met.normal);
  return v + met.normal * (met.restitution * approach - glm::dot(v - met.velocity, met.normal));
}

}  // namespace

void gauss_seidel_step(const World& of, State& state, double t, double t_next) {
  at_step(of, state, t);
  const World& world = at_time(of, t_next);
  const scene::Scene& scene = world.scene;
  const bool by_vertices = scene::sweeps_vertices(scene.solver.method);
  const bool passes = scene.collides(scene::ContactKind::points) || (!by_vertices && scene.has_solids());
  SweepState step = begin(world, state, t, t_next);
  for (int n = 0; n < scene.solver.iterations; ++n) {
    by_vertices ? sweep_vertices(step) : sweep_elements(step);
    if (passes) contact_pass(step);
  }
  if (by_vertices) balance_momentum(step);

  State next;
  next.step = state.step + 1;
  next.contacts = step.contacts;
  if (by_vertices) next.velocity_before = velocities_to_keep(step);
  for (std::uint32_t i = 0; i < step.x.size(); ++i) {
    next.position.push_back(step.now(i));
    next.velocity.push_back(bounced(step, i, step.displacement[i] / step.dt));
  }
  place_pins(world, t_next, next.position, next.velocity);
  limit_strain(world, state, next);
  state = std::move(next);
}

}  // namespace clothlab::reference
