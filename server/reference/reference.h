// The reference that GPU results are compared with: it steps the same scene in double precision and in the
// plainest form. It visits every element once and every pair of vertices that could touch, without a spatial
// hash. It shares only the element laws with the shaders.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "server/base/result.h"
#include "server/model/colouring.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::reference {

using glm::dvec3;

struct KeyedWorld;
struct State;
struct World;

/// Holds a world's KeyedWorld, which is made when it is first asked for. A copy of a world makes its own.
struct KeyedWorldSlot {
  mutable std::shared_ptr<KeyedWorld> made{};
  KeyedWorldSlot() = default;
  KeyedWorldSlot(const KeyedWorldSlot&) {}
  KeyedWorldSlot& operator=(const KeyedWorldSlot&) {
    made.reset();
    return *this;
  }
};

/// Everything that stays constant during a run, but for what keys set.
struct World {
  scene::Scene scene;
  model::Model model;
  std::vector<double> contact_margin;  ///< [cloth_count] distance kept from a collider's surface [m]
  std::array<model::Colouring, elements::swept_count>
      element_colours;              ///< the orders of PBD's and XPBD's sweeps
  model::Colouring vertex_colours;  ///< the order of VBD's sweeps
  KeyedWorldSlot keyed{};

  bool pinned(std::size_t vertex) const { return model.pin_motion[vertex] != model::not_pinned; }
};

struct State {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  std::vector<dvec3> velocity;  ///< [vertex_count] [m/s]
  std::vector<int>
      contacts;  ///< [vertex_count] colliders met and vertices touched in the last step; 0 if pinned
  std::uint64_t step = 0;  ///< number of steps since the start: the time is step * dt
  /// Verlet only, [vertex_count] or empty before its first step: the velocity half a step ago [m/s], and dt
  /// of that step [s]; where half_dt is 0, the next step starts from `velocity` instead.
  std::vector<dvec3> half_velocity = {};
  std::vector<double> half_dt = {};
  /// VBD only, [vertex_count] or empty before its first step: the velocity at the start of the last step
  /// [m/s]; none where the vertex hit a collider in an impact in that step.
  std::vector<std::optional<dvec3>> velocity_before = {};
  /// BDF2 only, [vertex_count] or empty where the next step is one of implicit Euler: the way [m] and the
  /// gain of velocity [m/s] of the last step.
  std::vector<dvec3> way = {}, gain = {};
  /// The residual that an implicit method left, as a share of the largest momentum in its equation; 0 after
  /// other methods.
  double residual = 0;
};

/// A world for `scene`, or an error that says why its model cannot be built.
Result<World> make_world(const scene::Scene& scene, const std::vector<double>& contact_margin);
/// The same, with one margin for all cloths.
Result<World> make_world(const scene::Scene& scene, double contact_margin);

/// The world with what keys set at time t [s]; the world itself if its scene has no keys. The same object
/// each time, until the next call. Pins are as at the start of the step under way.
const World& at_time(const World& world, double t);
/// To be called at the start of each step, at time t [s]: pins whose keys say so let go, and what a method
/// remembers of earlier steps in `state` is forgotten. Then as `at_time`.
const World& at_step(const World& world, State& state, double t);
/// The times from `from` on to `to` [s], both in the list, between which no key has a corner or a jump.
std::vector<double> between_keys(const World& world, double from, double to);

/// The state at time 0: start positions, and velocity 0.
State at_rest(const World& world);

/// Advances `state` by one step of dt with the scene's method (methods.h). Self-collision acts on the state
/// at the start. After the method's step, pins go to where their motions are at t + dt, then vertices that
/// would enter a collider stop at its surface, then the strain limit acts. PBD, XPBD and VBD treat contacts
/// within their iterations instead (gauss_seidel.h). Implicit Euler is solved to the rounding of double
/// precision, whatever `iterations` says.
void step(const World& world, State& state);

/// Like `step` under implicit Euler or BDF2, but with exactly `solver.iterations` Newton steps from the
/// velocity at the step's start, without a line search. With whole Newton steps the GPU computes the same, to
/// its solver's tolerance.
void limited_newton_step(const World& world, State& state);

/// Forces of the elements on each vertex [N].
std::vector<dvec3> element_forces(const World& world, const std::vector<dvec3>& position,
                                  const std::vector<dvec3>& velocity);

/// The acceleration of each vertex by elements, gravity, air drag and the wind at time t [s], as if no vertex
/// were pinned [m/s^2].
std::vector<dvec3> accelerations(const World& world, const std::vector<dvec3>& position,
                                 const std::vector<dvec3>& velocity, double t);

/// Sets position and velocity of the pinned vertices to those of their motions at time t [s].
void place_pins(const World& world, double t, std::vector<dvec3>& position, std::vector<dvec3>& velocity);

struct Energy {
  double kinetic = 0, elastic = 0,
         gravitational = 0;  ///< [J], of the whole scene; gravitational energy is 0 at the origin
  double total() const { return kinetic + elastic + gravitational; }
};
Energy energy(const World& world, const State& state);

}  // namespace clothlab::reference
