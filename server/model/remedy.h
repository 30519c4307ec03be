// Advice after a run has blown up: the change to the scene that makes it stable.
#pragma once

#include <optional>
#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Remedy {
  std::string text;                     ///< what the user should do, in the imperative
  double dt = 0;                        ///< [s]
  std::optional<scene::Method> method;  ///< the method to change to; none: keep the scene's
};

/// The remedy depends on the method, on the step and on `limit` [s], the method's longest stable step:
/// explicit Euler, which gains energy at nearly every step: symplectic Euler;
/// a step near or beyond `limit`: 0.8 of `limit`, or implicit Euler if that is less than a tenth of the step;
/// a step well below `limit`, which then cannot be the cause: implicit Euler;
/// implicit Euler itself: half the step.
Remedy remedy(const Model& model, const scene::Scene& scene, double limit);

/// Text that compares dt with `limit` [s], to be appended to the reason of a blow-up:
/// ": dt = 0.0025 s is 1.47 times the longest stable step of ...".
std::string against_limit(const scene::Solver& solver, double limit);

/// `value`, above 0, rounded down to two significant digits.
double rounded_down(double value);

}  // namespace clothlab::model
