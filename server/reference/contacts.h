// Contacts of the reference: a vertex against the scene's colliders and against every other vertex.
#pragma once

#include <optional>

#include "server/reference/reference.h"

namespace clothlab::reference {

/// Stops the step from -> x of a vertex with end velocity v at the colliders, as they move from time t to t +
/// dt. Returns the number of colliders met. `second`, if there is one, is another velocity of the vertex,
/// the one with which it has moved, and the contacts change it likewise. Friction takes as large a share of
/// the displacement as of the sliding.
int meet_colliders(const World& world, double t, const dvec3& from, dvec3& x, dvec3& v,
                   dvec3* second = nullptr);

/// What a vertex met: the unit normal there, the surface's velocity [m/s], friction, restitution.
struct Surface {
  dvec3 normal{0.0}, velocity{0.0};
  double friction = 0, restitution = 0;
};

/// The same for the position alone; `last` becomes the surface met last, if one is.
int stop_on_way(const World& world, double t, const dvec3& from, dvec3& x, Surface& last);

/// 1 / mass [1/kg], 0 if pinned.
double inverse_mass(const World& world, std::uint32_t vertex);

/// How far apart self-collision keeps two vertices [m]: at most their distance at rest within one cloth; none
/// if a spring joins them.
std::optional<double> kept_distance(const World& world, std::uint32_t i, std::uint32_t j);

struct SelfContact {
  dvec3 push{0.0};     ///< added to the position [m]
  dvec3 impulse{0.0};  ///< added to the velocity [m/s]
  int touched = 0;     ///< vertices that were too close
};

/// For each vertex, in rising order, those it could touch within a step from `state`: found along one axis,
/// as all pairs would take most of a long run's time.
model::Adjacency within_reach(const World& world, const State& state);

/// What self-collision does to vertex i, from the positions and velocities before the step.
SelfContact self_contact(const World& world, const State& state, const model::Adjacency& reach,
                         std::uint32_t i);

}  // namespace clothlab::reference
