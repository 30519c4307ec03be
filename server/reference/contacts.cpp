#include "server/reference/contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "server/model/motion.h"
#include "server/scene/solid.h"
#include "shaders/elements/elements.h"

namespace clothlab::reference {

namespace {

/// The collider `home` moved to `pose` and grown by a contact margin [m], in the form that its law takes.
elements::Solid solid_at(const scene::Solid& home, double margin, const model::Pose& pose) {
  return {pose.place(home.point), pose.rotation * home.direction, home.radius + margin,
          pose.rotation * home.second, home.extent};
}

/// Stops the step from -> x at one collider; true if the collider is in the way.
bool meet_solid(const World& world, const scene::Collider& collider, double t, double margin,
                const dvec3& from, dvec3& x, Surface& met) {
  const scene::Solid home = scene::solid(collider.shape);
  const model::Pose before = model::pose(collider.motion, t);
  const model::Pose after = model::pose(collider.motion, t + world.scene.solver.dt);
  dvec3 stopped, normal;
  if (!elements::solid_contact(home.kind, solid_at(home, margin, before), solid_at(home, margin, after), from,
                               x, stopped, normal))
    return false;
  x = stopped;
  met = {normal, after.velocity_at(x), collider.friction, collider.restitution};
  return true;
}

/// Stops the step from -> x at each collider in turn, one kind of shape after another, as on the GPU. Calls
/// touch(surface) for each collider met, and returns their number.
template <class Touch>
int meet_each(const World& world, double t, std::size_t vertex, const dvec3& from, dvec3& x, Touch touch) {
  const double margin = world.contact_margin[world.model.vertex_cloth[vertex]];
  int count = 0;
  Surface met;
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind)
    for (const scene::Collider& collider : world.scene.colliders) {
      if (collider.shape.index() != kind) continue;
      if (!meet_solid(world, collider, t, margin, from, x, met)) continue;
      touch(met);
      ++count;
    }
  return count;
}

}  // namespace

int meet_colliders(const World& world, double t, std::size_t vertex, const dvec3& from, dvec3& x, dvec3& v,
                   dvec3* second) {
  dvec3 braking(0.0);
  // Verlet moves its vertices with the second velocity.
  const dvec3* moves = second ? second : &v;
  const int count = meet_each(world, t, vertex, from, x, [&](const Surface& met) {
    const dvec3 moved = x - braking - from - world.scene.solver.dt * met.velocity;
    braking +=
        elements::contact_braking(moved, *moves - met.velocity, met.normal, met.friction, met.restitution);
    const auto after = [&](const dvec3& velocity) {
      return met.velocity +
             elements::contact_velocity(velocity - met.velocity, met.normal, met.friction, met.restitution);
    };
    v = after(v);
    if (second) *second = after(*second);
  });
  x -= braking;
  return count;
}

int stop_at_colliders_position(const World& world, double t, std::size_t vertex, const dvec3& from, dvec3& x,
                               Surface& last) {
  return meet_each(world, t, vertex, from, x, [&](const Surface& met) { last = met; });
}

double inverse_mass(const World& world, std::uint32_t vertex) {
  return world.pinned(vertex) ? 0.0 : 1.0 / world.model.mass[vertex];
}

std::optional<double> kept_distance(const World& world, std::uint32_t i, std::uint32_t j) {
  const model::Model& model = world.model;
  const model::Adjacency& excluded = model.contact_exclusions;
  const auto first = excluded.items.begin() + excluded.offsets[i],
             end = excluded.items.begin() + excluded.offsets[i + 1];
  if (i == j || std::binary_search(first, end, j)) return std::nullopt;
  const double thickness = world.scene.self_collision->thickness;
  if (model.vertex_cloth[i] != model.vertex_cloth[j]) return thickness;
  return std::min(thickness, glm::distance(model.rest_position[i], model.rest_position[j]));
}

model::Adjacency within_reach(const World& world, const State& state) {
  const std::size_t count = state.position.size();
  double fastest = 0.0;
  bool sound = true;
  for (std::size_t i = 0; i < count; ++i) {
    const double speed = glm::length(state.velocity[i]);
    sound = sound && std::isfinite(speed + glm::length(state.position[i]));
    fastest = std::max(fastest, speed);
  }
  model::Adjacency near{std::vector<std::uint32_t>(count + 1, 0), {}};
  if (!sound) return near;  // the run has failed already, and NaN cannot be sorted
  const double reach = world.scene.self_collision->thickness + 2.0 * fastest * world.scene.solver.dt;
  std::vector<std::uint32_t> along(count);
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(),
            [&](std::uint32_t a, std::uint32_t b) { return state.position[a].x < state.position[b].x; });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    const dvec3& x = state.position[along[a]];
    for (std::size_t b = a + 1; b < count && state.position[along[b]].x - x.x <= reach; ++b) {
      const dvec3 apart = state.position[along[b]] - x;
      if (glm::dot(apart, apart) > reach * reach) continue;
      pairs.emplace_back(along[a], along[b]);
      pairs.emplace_back(along[b], along[a]);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [a, b] : pairs) {
    ++near.offsets[a + 1];
    near.items.push_back(b);
  }
  for (std::size_t i = 0; i < count; ++i) near.offsets[i + 1] += near.offsets[i];
  return near;
}

SelfContact self_contact(const World& world, const State& state, const model::Adjacency& reach,
                         std::uint32_t i) {
  SelfContact contact;
  const double thickness = world.scene.self_collision->thickness, dt = world.scene.solver.dt;
  for (std::uint32_t item = reach.offsets[i]; item < reach.offsets[i + 1]; ++item) {
    const std::uint32_t j = reach.items[item];
    const double gap = glm::distance(state.position[i], state.position[j]);
    const double closing = glm::distance(state.velocity[i], state.velocity[j]) * dt;
    if (gap > thickness + closing) continue;  // cannot meet; spares the look-up below
    const std::optional<double> keep = kept_distance(world, i, j);
    dvec3 push, impulse;
    if (!keep ||
        !elements::self_contact(state.position[i], state.position[j], state.velocity[i], state.velocity[j],
                                *keep, world.scene.self_collision->friction, dt, push, impulse))
      continue;
    ++contact.touched;
    // The two vertices share the correction by inverse mass. The share is smaller where several contacts
    // would add up to more than is needed.
    const double contact_count = std::max({2, state.contacts[i], state.contacts[j]});
    const double share =
        inverse_mass(world, i) / (inverse_mass(world, i) + inverse_mass(world, j)) / contact_count;
    contact.push += share * push;
    contact.impulse += share * impulse;
  }
  return contact;
}

}  // namespace clothlab::reference
