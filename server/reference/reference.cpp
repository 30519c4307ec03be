#include "server/reference/reference.h"

#include <glm/geometric.hpp>

#include "server/model/motion.h"
#include "server/reference/contacts.h"
#include "server/reference/gauss_seidel.h"
#include "server/reference/methods.h"
#include "server/reference/strain_limit.h"
#include "server/reference/vectors.h"
#include "server/reference/wind.h"
#include "server/scene/method.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

/// Stops the free vertices of `next` at the colliders on their way from `before`.
void stop_at_colliders(const World& world, const State& before, double t, State& next) {
  for (std::size_t i = 0; i < next.position.size(); ++i) {
    if (world.pinned(i)) continue;
    // Verlet's contact is an impulse within the step: it changes the velocity in the middle of the step like
    // the velocity at its end.
    dvec3* half = next.half_dt.empty() ? nullptr : &next.half_velocity[i];
    next.contacts[i] +=
        meet_colliders(world, t, i, before.position[i], next.position[i], next.velocity[i], half);
  }
}

}  // namespace

Result<World> make_world(const scene::Scene& scene, double contact_margin) {
  return make_world(scene, std::vector<double>(scene.cloths.size(), contact_margin));
}

Result<World> make_world(const scene::Scene& scene, const std::vector<double>& contact_margin) {
  Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  World world{scene, std::move(*model), contact_margin, {}, {}, {}};
  world.element_colours = model::colour_elements(world.model, scene);
  world.vertex_colours = model::colour_vertices(world.model, scene);
  return world;
}

State at_rest(const World& world) {
  const std::size_t count = world.model.vertex_count();
  return State{world.model.start_position, Vectors(count, dvec3(0.0)), std::vector<int>(count, 0), 0};
}

Vectors element_forces(const World& world, const Vectors& x, const Vectors& v) {
  Vectors force(world.model.vertex_count(), dvec3(0.0));
  model::each_element(world.model.elements, [&](const auto& element) {
    dvec3& on_last = force[element.vertices.back()];  // the forces within an element sum to zero
    for (std::size_t corner = 0; corner + 1 < element.corners; ++corner) {
      const dvec3 on_corner =
          element_force(law_at(element, corner), edges(element, corner, x), edges(element, corner, v));
      force[element.vertices[corner]] += on_corner;
      on_last -= on_corner;
    }
  });
  return force;
}

Vectors accelerations(const World& of, const Vectors& x, const Vectors& v, double t) {
  const World& world = at_time(of, t);
  Vectors a = element_forces(world, x, v);
  for (std::size_t i = 0; i < a.size(); ++i)
    a[i] = a[i] / world.model.mass[i] + world.scene.gravity - world.scene.air_drag * v[i];
  add_wind(world, x, v, t, a);
  return a;
}

void place_pins(const World& world, double t, Vectors& x, Vectors& v) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!world.pinned(i)) continue;
    const auto motion = static_cast<std::size_t>(world.model.pin_motion[i]);
    const model::Pose pose = model::pose(world.model.motions[motion], t);
    x[i] = pose.place(world.model.rest_position[i]);
    v[i] = pose.velocity_at(x[i]);
  }
}

Energy energy(const World& world, const State& state) {
  Energy sum;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const double mass = world.model.mass[i];
    sum.kinetic += 0.5 * mass * glm::dot(state.velocity[i], state.velocity[i]);
    sum.gravitational -= mass * glm::dot(world.scene.gravity, state.position[i]);
  }
  model::each_element(world.model.elements, [&](const auto& element) {
    sum.elastic += element_energy(element.law, edges(element, 0, state.position));
  });
  return sum;
}

void advance(const StepMethod& method, const World& of, State& state, double t, double t_next) {
  const World& world = at_step(of, state, t);
  const std::uint32_t count = world.model.vertex_count();
  StepStart start{
      world, state, Vectors(count, dvec3(0.0)), Vectors(count, dvec3(0.0)), t, world.scene.solver.dt};
  std::vector<int> touched(count, 0);
  at_time(world, t_next);  // friction and restitution are those of the step's end
  const model::Adjacency reach =
      world.scene.collides(scene::ContactKind::points) ? within_reach(world, state) : model::Adjacency{};
  for (std::uint32_t i = 0; world.scene.collides(scene::ContactKind::points) && i < count; ++i) {
    if (world.pinned(i)) continue;
    const SelfContact contact = self_contact(world, state, reach, i);
    start.push[i] = contact.push;
    start.impulse[i] = contact.impulse;
    touched[i] = contact.touched;
  }
  const auto solve = [&] {
    State end = method(start);
    end.step = state.step + 1;
    end.contacts = touched;
    at_time(world, t_next);
    place_pins(world, t_next, end.position, end.velocity);
    stop_at_colliders(world, state, t, end);
    return end;
  };
  State next = solve();
  if (world.scene.solver.method == scene::Method::bdf2) {
    const bool by_formula = !state.way.empty();
    if (!note_step(start, next) && by_formula) {
      state.way = state.gain = {};  // then by backward Euler
      next = solve();
      note_step(start, next);
    }
  }
  limit_strain(world, state, next);
  state = std::move(next);
}

void step(const World& world, State& state) {
  const double dt = world.scene.solver.dt, n = static_cast<double>(state.step);
  if (scene::sweeps(world.scene.solver.method)) return gauss_seidel_step(world, state, n * dt, (n + 1) * dt);
  advance(step_method(world.scene.solver.method), world, state, n * dt, (n + 1) * dt);
}

void limited_newton_step(const World& world, State& state) {
  const double dt = world.scene.solver.dt, n = static_cast<double>(state.step);
  advance(limited_newton, world, state, n * dt, (n + 1) * dt);
}

}  // namespace clothlab::reference
