// Contacts of the reference: a vertex against the scene's colliders and against every other vertex.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

/// Stops the step from -> x of a vertex with end velocity v at the colliders, as they move from time t to t +
/// dt. Returns the number of colliders met.
int meet_colliders(const World& world, double t, const dvec3& from, dvec3& x, dvec3& v);

struct SelfContact {
  dvec3 push{0.0};     ///< added to the position [m]
  dvec3 impulse{0.0};  ///< added to the velocity [m/s]
  int touched = 0;     ///< vertices that were too close
};

/// What self-collision does to vertex i, from the positions and velocities before the step.
SelfContact self_contact(const World& world, const State& state, std::uint32_t i);

}  // namespace clothlab::reference
