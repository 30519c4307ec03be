#include "server/reference/contacts.h"

#include <algorithm>
#include <cmath>

#include "server/model/motion.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

/// The vertex's velocity after it met a surface with unit normal n that moves with `pose`.
dvec3 after_contact(const scene::Collider& collider, const model::Pose& pose, const dvec3& x, const dvec3& n,
                    const dvec3& v) {
  const dvec3 moving = pose.velocity_at(x);
  return moving + elements::contact_velocity(v - moving, n, collider.friction, collider.restitution);
}

bool meet_sphere(const World& world, const scene::Collider& collider, double t, const dvec3& from, dvec3& x,
                 dvec3& v) {
  const auto& sphere = std::get<scene::Sphere>(collider.shape);
  const model::Pose before = model::pose(collider.motion, t);
  const model::Pose after = model::pose(collider.motion, t + world.scene.solver.dt);
  const dvec3 centre = after.place(sphere.center);
  dvec3 stopped, normal;
  if (!elements::sphere_contact(from - before.place(sphere.center), x - centre,
                                sphere.radius + world.contact_margin, stopped, normal))
    return false;
  x = centre + stopped;
  v = after_contact(collider, after, x, normal, v);
  return true;
}

bool meet_plane(const World& world, const scene::Collider& collider, double t, dvec3& x, dvec3& v) {
  const auto& plane = std::get<scene::Plane>(collider.shape);
  const model::Pose after = model::pose(collider.motion, t + world.scene.solver.dt);
  const dvec3 normal = after.rotation * plane.normal;
  const double depth = world.contact_margin - glm::dot(x - after.place(plane.point), normal);
  if (!(depth > 0.0)) return false;
  x += depth * normal;
  v = after_contact(collider, after, x, normal, v);
  return true;
}

}  // namespace

int meet_colliders(const World& world, double t, const dvec3& from, dvec3& x, dvec3& v) {
  int met = 0;
  for (const scene::Collider& collider : world.scene.colliders)  // spheres first, as on the GPU
    if (std::holds_alternative<scene::Sphere>(collider.shape))
      met += meet_sphere(world, collider, t, from, x, v);
  for (const scene::Collider& collider : world.scene.colliders)
    if (std::holds_alternative<scene::Plane>(collider.shape)) met += meet_plane(world, collider, t, x, v);
  return met;
}

SelfContact self_contact(const World& world, const State& state, std::uint32_t i) {
  SelfContact contact;
  const model::Model& model = world.model;
  const auto inverse_mass = [&](std::uint32_t vertex) {
    return model.pin_motion[vertex] == model::not_pinned ? 1.0 / model.mass[vertex] : 0.0;
  };
  const double thickness = world.scene.self_collision->thickness, dt = world.scene.solver.dt;
  for (std::uint32_t j = 0; j < model.vertex_count(); ++j) {
    const double gap = glm::distance(state.position[i], state.position[j]);
    const double closing = glm::distance(state.velocity[i], state.velocity[j]) * dt;
    if (j == i || gap > thickness + closing) continue;  // cannot meet; spares the look-up below
    if (world.joined.contains({std::min(i, j), std::max(i, j)})) continue;
    const bool same_cloth = model.vertex_cloth[i] == model.vertex_cloth[j];
    const double rest = glm::distance(model.rest_position[i], model.rest_position[j]);
    const double keep = same_cloth ? std::min(thickness, rest) : thickness;
    dvec3 push, impulse;
    if (!elements::self_contact(state.position[i], state.position[j], state.velocity[i], state.velocity[j],
                                keep, world.scene.self_collision->friction, dt, push, impulse))
      continue;
    ++contact.touched;
    // Each vertex takes its share by inverse mass, less where several contacts would add up to more than is
    // needed.
    const double crowd = std::max({2, state.contacts[i], state.contacts[j]});
    const double share = inverse_mass(i) / (inverse_mass(i) + inverse_mass(j)) / crowd;
    contact.push += share * push;
    contact.impulse += share * impulse;
  }
  return contact;
}

}  // namespace clothlab::reference
