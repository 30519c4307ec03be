// The vibration that limits the time step: found by iteration, from any start and without a matrix.
#pragma once

#include <functional>
#include <stop_token>

#include "server/model/element_operator.h"

namespace clothlab::model {

/// A vibration as a method sees it: x'' + damping x' + omega_squared x = 0. Of a vector y of length 1,
/// omega_squared = y.Ky and damping = y.Cy.
struct Mode {
  double omega_squared = 0;  ///< [1/s^2]
  double damping = 0;        ///< [1/s]
};

/// What is to be made least: the longest stable step of a mode [s].
using LimitOfMode = std::function<double(const Mode&)>;

struct ExtremeMode {
  Mode mode;
  Field y;  ///< of length 1
  int iterations = 0;
};

/// The unit vector whose mode has the least limit. Locally optimal conjugate gradients (Knyazev 2001,
/// without a preconditioner): each iteration is the power method's, made better by also searching along the
/// last change. It approaches from one side, so the limit found is never too short, and stops where ten
/// iterations change it by less than 1e-4 of itself. Every start that is not special does; `stop` ends it
/// early with the best so far.
ExtremeMode extreme_mode(const ElementOperator& elements, const LimitOfMode& limit, Field start,
                         const std::stop_token& stop = {});

/// A start without structure, the same every time; 0 at pinned vertices.
Field scattered_start(const ElementOperator& elements);

}  // namespace clothlab::model
