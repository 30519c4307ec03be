// Where a cloth hangs still: the minimum of its elastic and gravitational energy, by Newton's method.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

struct RestShape {
  std::vector<dvec3> position;  ///< [vertex_count] [m]
  double residual = 0;          ///< the largest force left on a free vertex [N]
  int iterations = 0;           ///< Newton steps taken
};

/// Springs and gravity in balance, the pins where they are at time 0, from the rest positions downhill: a
/// nearby minimum, not always the lowest. An error that says why where there is none: a vertex that nothing
/// holds, a shape that would be inside a collider or beyond a strain limit (neither is treated), or no
/// convergence.
Result<RestShape> rest_shape(const World& world);

}  // namespace clothlab::reference
