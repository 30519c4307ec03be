// The shape in which a cloth hangs still: a minimum of its elastic and gravitational energy, by Newton's
// method.
#pragma once

#include <stop_token>

#include "server/reference/reference.h"

namespace clothlab::reference {

struct RestShape {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  double residual = 0;          ///< the largest force left on a free vertex [N]
  int iterations = 0;           ///< Newton steps taken
};

/// Finds a shape in which springs and gravity balance, with the pins where they are at time 0. Descends from
/// the rest positions, or from `start` [vertex_count] [m], to a nearby minimum, which need not be the lowest.
/// An error says why there is no such shape: nothing holds a vertex, the shape would be inside a collider or
/// beyond a strain limit (both are only checked), or no convergence, also when `stop` ends the search.
Result<RestShape> rest_shape(const World& world);
Result<RestShape> rest_shape(const World& world, std::vector<dvec3> start, const std::stop_token& stop);

}  // namespace clothlab::reference
