// The change to a scene that makes it stable: advice after a run has blown up, and what a change of the cloth
// asks for that is not to blow up.
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

/// A solver under which the cloth of `scene` holds: the scene's own, if its step is within `margin_to_warn`
/// of the longest stable one; else a shorter step, if half of it is enough; else implicit Euler with a step
/// of a frame and one solve, which is the cheapest for stiff cloth. (`remedy` keeps the step under implicit
/// Euler, as it does not know why the run has blown up.)
scene::Solver solver_that_holds(const Model& model, const scene::Scene& scene);

/// The scene's solver with a step under which its method holds, however short. A method that holds at no step
/// keeps its own.
scene::Solver step_that_holds(const Model& model, const scene::Scene& scene);

/// Text that compares dt with `limit` [s], to be appended to the reason of a blow-up:
/// ": dt = 0.0025 s is 1.47 times the longest stable step of ...".
std::string against_limit(const scene::Solver& solver, double limit);

/// `value`, above 0, rounded down to two significant digits.
double rounded_down(double value);

}  // namespace clothlab::model
