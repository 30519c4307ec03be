// Contacts in the reference: of a vertex with the scene's colliders and with the other vertices.
#pragma once

#include <optional>

#include "server/reference/reference.h"

namespace clothlab::reference {

/// Stops the step from -> x of a vertex with end velocity v at the colliders, which move from time t to t +
/// dt and which it keeps its cloth's distance from. Changes x and v; returns the number of colliders met. If
/// the vertex has moved with a velocity other than v, `second` points to that velocity, and contacts change
/// it like v. Friction takes as large a share of the displacement as of the sliding velocity.
int meet_colliders(const World& world, double t, std::size_t vertex, const dvec3& from, dvec3& x, dvec3& v,
                   dvec3* second = nullptr);

/// The surface that a vertex met: unit normal and velocity [m/s] at the vertex, friction, restitution.
struct Surface {
  dvec3 normal{0.0}, velocity{0.0};
  double friction = 0, restitution = 0;
};

/// Like meet_colliders, but changes only the position x. If it meets a collider, `last` becomes the surface
/// met last.
int stop_at_colliders_position(const World& world, double t, std::size_t vertex, const dvec3& from, dvec3& x,
                               Surface& last);

/// 1 / mass [1/kg], 0 if pinned.
double inverse_mass(const World& world, std::uint32_t vertex);

/// The distance that self-collision keeps between two vertices [m]: the thickness, but within one cloth at
/// most their distance at rest. None if an element joins them.
std::optional<double> kept_distance(const World& world, std::uint32_t i, std::uint32_t j);

struct SelfContact {
  dvec3 push{0.0};     ///< added to the position [m]
  dvec3 impulse{0.0};  ///< added to the velocity [m/s]
  int touched = 0;     ///< number of vertices too close, now or within the step
};

/// For each vertex the other vertices that it could touch within one step from `state`, in rising order;
/// empty if a value in `state` is not finite. Sorts along one axis, because a test of all pairs would
/// dominate the time of a long run.
model::Adjacency within_reach(const World& world, const State& state);

/// The effect of self-collision on vertex i, from the positions and velocities before the step.
SelfContact self_contact(const World& world, const State& state, const model::Adjacency& reach,
                         std::uint32_t i);

}  // namespace clothlab::reference
