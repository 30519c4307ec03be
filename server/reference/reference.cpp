#include "server/reference/reference.h"

#include "server/model/motion.h"
#include "server/reference/contacts.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

Result<World> make_world(const scene::Scene& scene, double contact_margin) {
  Result<model::Model> model = model::build(scene);
  if (!model) return model.error();
  World world{scene, std::move(*model), contact_margin, {}};
  for (const model::Spring& spring : world.model.springs) world.joined.insert({spring.a, spring.b});
  return world;
}

State at_rest(const World& world) {
  const std::size_t count = world.model.vertex_count();
  return State{world.model.rest_position, std::vector<dvec3>(count, dvec3(0.0)), std::vector<int>(count, 0),
               0};
}

std::vector<dvec3> spring_forces(const World& world, const State& state) {
  std::vector<dvec3> force(world.model.vertex_count(), dvec3(0.0));
  for (const model::Spring& spring : world.model.springs) {
    const scene::Springs& material = world.scene.cloths[spring.cloth].material;
    const dvec3 on_a =
        elements::spring_force(state.position[spring.a], state.position[spring.b], state.velocity[spring.a],
                               state.velocity[spring.b], spring.rest_length,
                               model::stiffness(material, spring.kind), material.damping);
    force[spring.a] += on_a;
    force[spring.b] -= on_a;
  }
  return force;
}

void step(const World& world, State& state) {
  const scene::Scene& scene = world.scene;
  const double dt = scene.solver.dt;
  const double t = static_cast<double>(state.step) * dt, t_next = static_cast<double>(state.step + 1) * dt;
  const std::vector<dvec3> force = spring_forces(world, state);
  State next = state;
  next.step = state.step + 1;
  for (std::uint32_t i = 0; i < world.model.vertex_count(); ++i) {
    dvec3 x = state.position[i], v = state.velocity[i];
    if (const std::int32_t pin = world.model.pin_motion[i]; pin != model::not_pinned) {
      const model::Pose pose = model::pose(world.model.motions[static_cast<std::size_t>(pin)], t_next);
      next.position[i] = pose.place(world.model.rest_position[i]);
      next.velocity[i] = pose.velocity_at(next.position[i]);
      continue;
    }
    const SelfContact contact = scene.self_collision ? self_contact(world, state, i) : SelfContact{};
    v += dt * (force[i] / world.model.mass[i] + scene.gravity - scene.air_drag * v) + contact.impulse;
    x += contact.push + dt * v;
    const int met = meet_colliders(world, t, state.position[i], x, v);
    next.position[i] = x;
    next.velocity[i] = v;
    next.contacts[i] = contact.touched + met;
  }
  state = std::move(next);
}

}  // namespace clothlab::reference
