// Where a cloth hangs still: the minimum of its elastic and gravitational energy, by Newton's method.
#pragma once

#include <stop_token>

#include "server/reference/reference.h"

namespace clothlab::reference {

struct RestShape {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  double residual = 0;          ///< the largest force left on a free vertex [N]
  int iterations = 0;           ///< Newton steps taken
};

/// Springs and gravity in balance, the pins where they are at time 0, downhill from the rest positions or
/// from `start` [vertex_count] [m]: a nearby minimum, not always the lowest. An error that says why where
/// there is none: a vertex that nothing holds, a shape that would be inside a collider or beyond a strain
/// limit (neither is treated), or no convergence, as when `stop` ends the search.
Result<RestShape> rest_shape(const World& world);
Result<RestShape> rest_shape(const World& world, std::vector<dvec3> start, const std::stop_token& stop);

}  // namespace clothlab::reference
