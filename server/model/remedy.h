// What to change in a scene whose run has blown up, so that it holds.
#pragma once

#include <optional>
#include <string>

#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

struct Remedy {
  std::string text;                     ///< what to do, as a command to the user
  double dt = 0;                        ///< [s]
  std::optional<scene::Method> method;  ///< another one than the scene has
};

/// 0.8 of the limit where the step is near or beyond it, implicit Euler where that would be less than a tenth
/// of the step or where the limit cannot be the cause, and of implicit Euler itself half the step; for
/// explicit Euler, which gains energy at nearly every step, symplectic Euler. `limit` [s] is the one of the
/// scene's own method.
Remedy remedy(const Model& model, const scene::Scene& scene, double limit);

/// How dt stands to its limit, for after the reason: ": dt = 0.0025 s is 1.47 times 0.001701 s, ...".
std::string against_limit(const scene::Solver& solver, double limit);

/// The largest number of two digits that is no larger; `value` above 0.
double rounded_down(double value);

}  // namespace clothlab::model
