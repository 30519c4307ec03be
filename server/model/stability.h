// How long a step may be: each method's limit for one vibration, and the limit of a whole scene, which is
// that of its worst vibration about the rest shape. Contacts, bends of large angle and Provot's strain_limit
// have no part in it.
#pragma once

#include <limits>
#include <optional>
#include <stop_token>
#include <string>

#include "server/model/extreme_mode.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// Any step is stable.
inline constexpr double no_limit = std::numeric_limits<double>::infinity();

/// The longest stable step [s] for one vibration; `no_limit` where there is none, 0 where no step is stable
/// (explicit Euler without damping). Damping in symplectic Euler and in Verlet is that of this project: the
/// former takes the velocity of the step before, the latter one that it predicts.
double dt_limit(scene::Method method, const Mode& mode);

/// Whether the worst vibration is one of the largest of a single matrix: then any start of a search finds it.
bool one_worst(scene::Method method);

/// The largest angular frequency [rad/s] of the elements about the rest shape, without damping: no less, at
/// the cost of a pass over the elements ...
double omega_bound(const Model& model, const scene::Scene& scene);
/// ... and sharp, from below, to about 0.1 %; about `shape` [vertex_count] [m] instead, tension included.
double omega_max(const Model& model, const scene::Scene& scene);
double omega_max(const Model& model, const scene::Scene& scene, const Field& shape);

/// The longest stable step [s] of a method on a cloth, damping and air drag included: never too long, at the
/// cost of a pass over the elements ...
double dt_limit_bound(scene::Method method, const ElementOperator& elements);
/// ... and sharp, from above, to about 0.1 %: some 60 passes. `stop` makes it give up and return the bound.
double dt_limit(scene::Method method, const ElementOperator& elements, const std::stop_token& stop = {});

/// The same two for a scene as it lies at rest, with its own method.
double dt_limit_bound(const Model& model, const scene::Scene& scene);
double dt_limit(const Model& model, const scene::Scene& scene);
/// The sharp limit where the scene's own dt is near it, else the bound, which is enough to know that it is
/// not.
double dt_limit_if_near(const Model& model, const scene::Scene& scene);

/// Above this share of the limit users are warned: contacts and large bends may add a little.
inline constexpr double margin_to_warn = 0.9;

/// dt over the limit. None where nothing limits the step, and where no step is stable.
std::optional<double> margin(double dt, double limit);
/// What to tell about a step above `margin_to_warn` of the limit, in a sentence; empty where all is well.
std::string step_warning(const scene::Solver& solver, double limit);

}  // namespace clothlab::model
