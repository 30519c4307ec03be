// The truth the GPU is held against: the same scene, one step at a time, in double precision and in the
// plainest form. Every element once, every pair of vertices that could touch, no hash; only the element laws
// are shared with the shaders.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "server/base/result.h"
#include "server/model/colouring.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::reference {

using glm::dvec3;

/// What does not change while it runs.
struct World {
  scene::Scene scene;
  model::Model model;
  double contact_margin = 0;                        ///< distance kept from a collider's surface [m]
  model::Colouring spring_colours, vertex_colours;  ///< the orders of Gauss-Seidel sweeps

  bool pinned(std::size_t vertex) const { return model.pin_motion[vertex] != model::not_pinned; }
};

struct State {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  std::vector<dvec3> velocity;  ///< [vertex_count] [m/s]
  std::vector<int>
      contacts;  ///< [vertex_count] of the last step: colliders met and vertices touched; 0 if pinned
  std::uint64_t step = 0;  ///< steps since the start: the time is step * dt
  /// Verlet's own, [vertex_count] or empty before its first step: the velocity half a step ago [m/s], and the
  /// dt of that half step [s], 0 where the velocity is of now.
  std::vector<dvec3> half_velocity = {};
  std::vector<double> half_dt = {};
  /// VBD's own, [vertex_count] or empty before its first step: the velocity at the start of the last step
  /// [m/s]; none where that was one of an impact.
  std::vector<std::optional<dvec3>> velocity_before = {};
  /// What an implicit method left unsolved, as a share of the largest momentum in its equation; 0 after
  /// others.
  double residual = 0;
};

/// A world for `scene`, or why its model cannot be built.
Result<World> make_world(const scene::Scene& scene, double contact_margin);

/// Where the cloths start, nothing moving, at time 0.
State at_rest(const World& world);

/// One step of dt by the scene's method (methods.h). Self-collision acts from the state at the start; pins
/// are put where their motion is at t + dt; a vertex that would enter a collider on its way is stopped at the
/// surface; then the strain limit. PBD, XPBD and VBD meet contacts within their iterations
/// (gauss_seidel.h). Implicit Euler is solved to the rounding of double precision, whatever
/// `iterations` says.
void step(const World& world, State& state);

/// The same with Baraff & Witkin's implicit Euler in the place of the method: at most `solver.iterations`
/// Newton steps, none of them searched along. What the GPU computes, less the tolerance of its linear solver.
void baraff_witkin_step(const World& world, State& state);

/// Forces of the elements on each vertex [N].
std::vector<dvec3> element_forces(const World& world, const std::vector<dvec3>& position,
                                  const std::vector<dvec3>& velocity);

/// What elements, gravity and air drag do to each vertex, as if none were pinned [m/s^2].
std::vector<dvec3> accelerations(const World& world, const std::vector<dvec3>& position,
                                 const std::vector<dvec3>& velocity);

/// Puts the pinned vertices where their motions take them at time t [s], with the velocity they have there.
void place_pins(const World& world, double t, std::vector<dvec3>& position, std::vector<dvec3>& velocity);

struct Energy {
  double kinetic = 0, elastic = 0,
         gravitational = 0;  ///< [J], of all vertices; gravitational 0 at the origin
  double total() const { return kinetic + elastic + gravitational; }
};
Energy energy(const World& world, const State& state);

}  // namespace clothlab::reference
