// The longest stable time step: each method's limit for one vibration, and the limit of a whole scene, which
// is that of its worst vibration about the rest shape. The limit does not account for contacts, large bends,
// Provot's strain_limit or wind. With s = dt braking / mass (shaders/elements/wind.glsl, which keeps s below
// 1, or a half under Verlet), wind makes it sqrt(1 - s / 2) times as long under symplectic Euler, sqrt(1 - s)
// times under Verlet.
#pragma once

#include <limits>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/model/extreme_mode.h"
#include "server/model/model.h"
#include "server/scene/scene.h"

namespace clothlab::model {

/// The limit where every step is stable.
inline constexpr double no_limit = std::numeric_limits<double>::infinity();

/// The longest stable step [s] for one vibration; `no_limit` where every step is stable, 0 where none is
/// (explicit Euler without damping). The damping is as in this project: symplectic Euler takes it from the
/// velocity of the step before, Verlet from a predicted velocity.
double dt_limit(scene::Method method, const Mode& mode);

/// True if the worst vibration has the largest eigenvalue of a single matrix: any start of a search finds it.
bool has_single_worst_mode(scene::Method method);

/// An upper bound of omega_max about the rest shape [rad/s], at the cost of one pass over the elements.
double omega_bound(const Model& model, const scene::Scene& scene);
/// The largest angular frequency [rad/s] of the elements without damping, at most about 0.1 % too low; about
/// the rest shape, or about `shape` [vertex_count] [m], tension included.
double omega_max(const Model& model, const scene::Scene& scene);
double omega_max(const Model& model, const scene::Scene& scene, const Field& shape);

/// A lower bound of the longest stable step [s] of a method on a cloth, damping and air drag included, at the
/// cost of one pass over the elements.
double dt_limit_bound(scene::Method method, const ElementOperator& elements);
/// The longest stable step itself [s], at most about 0.1 % too long, at the cost of some 60 passes. `stop`
/// ends the search early; then it returns the lower bound.
double dt_limit(scene::Method method, const ElementOperator& elements, const std::stop_token& stop = {});

/// The lower bound, and the longest stable step [s] of a method on a scene's cloth, about the rest shape.
/// With keys of what decides it, the shortest over the scenes that have these at their extremes
/// (scene::extremes).
double dt_limit_bound(scene::Method method, const Model& model, const scene::Scene& scene);
double dt_limit(scene::Method method, const Model& model, const scene::Scene& scene,
                const std::stop_token& stop = {});
/// The cloths about the rest shape that these are of.
std::vector<ElementOperator> extreme_operators(const Model& model, const scene::Scene& scene);

/// The lower bound and the longest stable step [s] of the scene's own method, about the rest shape.
double dt_limit_bound(const Model& model, const scene::Scene& scene);
double dt_limit(const Model& model, const scene::Scene& scene);
/// The longest stable step [s] if the scene's dt is near or above the lower bound; else the lower bound,
/// which already shows that dt is well below the limit.
double dt_limit_if_near(const Model& model, const scene::Scene& scene);

/// Users are warned if dt is above this share of the limit: contacts and large bends may lower the limit a
/// little.
inline constexpr double margin_to_warn = 0.9;

/// dt / limit. None where every step is stable and where no step is.
std::optional<double> margin(double dt, double limit);
/// A warning to the user if dt is above `margin_to_warn` of the limit; empty if it is not.
std::string step_warning(const scene::Solver& solver, double limit);

}  // namespace clothlab::model
