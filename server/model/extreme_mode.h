// Finds the vibration that limits the time step, by iteration from any start and without a stored matrix.
#pragma once

#include <functional>
#include <stop_token>

#include "server/model/element_operator.h"

namespace clothlab::model {

/// A vibration as a time-stepping method sees it: x'' + damping x' + omega_squared x = 0. A vector y of
/// length 1 has omega_squared = y.Ky and damping = y.Cy (K and C: see element_operator.h).
struct Mode {
  double omega_squared = 0;  ///< [1/s^2]
  double damping = 0;        ///< [1/s]
};

/// The function to be minimised: the longest stable step of a mode [s].
using LimitOfMode = std::function<double(const Mode&)>;

struct ExtremeMode {
  Mode mode;
  Field y;  ///< the vector of `mode`, of length 1
  int iterations = 0;
};

/// Finds the unit vector whose mode has the least limit. Locally optimal conjugate gradients (Knyazev 2001,
/// without a preconditioner): each iteration improves on the power method by also searching along the last
/// change. The limit falls towards the least one, so that the limit found is never too short. The search
/// stops when ten iterations lower the limit by less than 1e-4 of itself. Any start without special structure
/// will do. `stop` ends the search early with the best vector so far.
ExtremeMode extreme_mode(const ElementOperator& elements, const LimitOfMode& limit, Field start,
                         const std::stop_token& stop = {});

/// A pseudo-random start without structure, the same on every call; 0 at pinned vertices.
Field scattered_start(const ElementOperator& elements);

}  // namespace clothlab::model
