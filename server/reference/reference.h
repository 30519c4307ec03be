// The truth the GPU is held against: the same scene, one step at a time, in double precision and in the
// plainest form. Every spring once and every pair of vertices, no lists and no hash; only the element laws
// are shared with the shaders.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <set>
#include <utility>
#include <vector>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::reference {

using glm::dvec3;

/// What does not change while it runs.
struct World {
  scene::Scene scene;
  model::Model model;
  double contact_margin = 0;  ///< distance kept from a collider's surface [m]
  std::set<std::pair<std::uint32_t, std::uint32_t>>
      joined;  ///< pairs (a, b) with a spring between them, a < b
};

struct State {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  std::vector<dvec3> velocity;  ///< [vertex_count] [m/s]
  std::vector<int>
      contacts;  ///< [vertex_count] of the last step: colliders met and vertices touched; 0 if pinned
  std::uint64_t step = 0;  ///< steps since the start: the time is step * dt
};

Result<World> make_world(const scene::Scene& scene, double contact_margin);

/// The rest shape, at time 0.
State at_rest(const World& world);

/// One step of symplectic Euler from (x, v) at time t: v += a(x, v) dt, then x += v dt. Pins are put where
/// their motion is at t + dt; a vertex that would enter a collider on its way is stopped at the surface.
void step(const World& world, State& state);

/// Forces of the springs on each vertex [N].
std::vector<dvec3> spring_forces(const World& world, const State& state);

}  // namespace clothlab::reference
