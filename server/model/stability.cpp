#include "server/model/stability.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "server/base/text.h"
#include "server/scene/keys.h"
#include "server/scene/method.h"

namespace clothlab::model {

namespace {

using scene::Method;

/// The positive root dt of dt^2 omega^2 + factor dt damping = 4 [s]. With this dt a step of a method whose
/// damping takes an older or predicted velocity maps x to -x; with a longer dt the vibration grows.
double flip_limit(double factor, const Mode& mode) {
  const double half = 0.5 * factor * mode.damping;
  // Written so that nothing cancels: 4 / (half + sqrt(half^2 + 4 omega^2)).
  return 4.0 / (half + std::sqrt(half * half + 4.0 * mode.omega_squared));
}

/// The root of s^2 + damping s + omega^2 farthest from 0.
std::complex<double> farthest_root(const Mode& mode) {
  const double half = 0.5 * mode.damping, square = half * half - mode.omega_squared;
  if (square >= 0.0) return -half - std::sqrt(square);
  return {-half, std::sqrt(-square)};
}

/// The dt [s] at which explicit Euler's growth |1 + s dt| is 1, for the root s farthest from 0.
double explicit_limit(const Mode& mode) {
  const std::complex<double> root = farthest_root(mode);
  return -2.0 * root.real() / std::norm(root);
}

/// The dt [s] at which RK4's growth |1 + w + w^2/2 + w^3/6 + w^4/24|, w = s dt, is 1, for the root s farthest
/// from 0. In the left half plane |w| is then between 2.6 and 3, and a ray from 0 leaves the stable region
/// only once (Hairer & Wanner 1996, section IV.2).
double rk4_limit(const Mode& mode) {
  const std::complex<double> root = farthest_root(mode), direction = root / std::abs(root);
  double inside = 2.0, outside = 4.0;
  for (int halving = 0; halving < 52; ++halving) {
    const double radius = 0.5 * (inside + outside);
    const std::complex<double> w = radius * direction;
    const std::complex<double> growth = 1.0 + w * (1.0 + w / 2.0 * (1.0 + w / 3.0 * (1.0 + w / 4.0)));
    (std::norm(growth) <= 1.0 ? inside : outside) = radius;
  }
  return inside / std::abs(root);
}

constexpr double symplectic_lag = 2.0, verlet_lag = 4.0;

double undamped_limit(const Mode& mode) {
  return 1.0 / std::sqrt(mode.omega_squared);
}
double overdamped_limit(const Mode& mode) {
  return 1.0 / mode.damping;
}

}  // namespace

bool has_single_worst_mode(Method method) {
  return method == Method::symplectic_euler || method == Method::verlet;
}

double dt_limit(Method method, const Mode& found) {
  // Both are sums of squares: a value below 0 is a rounding error.
  const Mode mode{std::max(0.0, found.omega_squared), std::max(0.0, found.damping)};
  if (!(mode.omega_squared > 0.0) && !(mode.damping > 0.0)) return no_limit;
  switch (method) {
    case Method::explicit_euler:
      return explicit_limit(mode);
    case Method::symplectic_euler:
      return flip_limit(symplectic_lag, mode);
    case Method::verlet:
      return flip_limit(verlet_lag, mode);
    case Method::rk4:
      return rk4_limit(mode);
    case Method::implicit_euler:
    case Method::pbd:
    case Method::xpbd:
    case Method::vbd:
    case Method::bdf2:
      return no_limit;
  }
  return no_limit;
}

double omega_bound(const Model& model, const scene::Scene& scene) {
  return std::sqrt(ElementOperator(model, scene, model.rest_position).stiffness_bound());
}

double omega_max(const Model& model, const scene::Scene& scene) {
  return omega_max(model, scene, model.rest_position);
}

double omega_max(const Model& model, const scene::Scene& scene, const Field& shape) {
  const ElementOperator elements(model, scene, shape);
  return std::sqrt(extreme_mode(elements, undamped_limit, scattered_start(elements)).mode.omega_squared);
}

double dt_limit_bound(Method method, const ElementOperator& elements) {
  if (!elements.any_free()) return no_limit;
  if (elements.empty() || scene::any_step_is_stable(method))
    return dt_limit(method, {0.0, elements.air_drag()});
  const Mode worst{elements.stiffness_bound(), elements.damping_bound()};
  switch (method) {
    case Method::explicit_euler:
      return std::min(elements.least_damping_time() + elements.air_drag() / worst.omega_squared,
                      worst.damping > 0.0 ? 2.0 / worst.damping : no_limit);
    case Method::symplectic_euler:
    case Method::verlet:
      return dt_limit(method, worst);
    case Method::rk4:
      // No vibration's root s of s^2 + damping s + omega^2 is farther from 0 than this divisor [1/s].
      return 2.6 / std::max(std::sqrt(worst.omega_squared), worst.damping);
    case Method::implicit_euler:
    case Method::pbd:
    case Method::xpbd:
    case Method::vbd:
    case Method::bdf2:
      break;  // stable at any step
  }
  return no_limit;
}

double dt_limit(Method method, const ElementOperator& elements, const std::stop_token& stop) {
  if (!elements.any_free()) return no_limit;
  // A cloth that moves as a whole strains no element: only air drag acts on it.
  double least = dt_limit(method, {0.0, elements.air_drag()});
  if (elements.empty() || scene::any_step_is_stable(method)) return least;
  if (method == Method::explicit_euler && elements.air_drag() == 0.0 && elements.least_damping_time() == 0.0)
    return 0.0;
  const auto of_mode = [&](const Mode& mode) { return dt_limit(method, mode); };
  const auto search = [&](Field start) {
    least = std::min(least, of_mode(extreme_mode(elements, of_mode, std::move(start), stop).mode));
  };
  const Field scattered = scattered_start(elements);
  if (has_single_worst_mode(method)) {
    search(scattered);
  } else {
    // The worst vibration is near the stiffest or near the most damped one: search from both.
    search(extreme_mode(elements, undamped_limit, scattered, stop).y);
    if (elements.damping_bound() > 0.0) search(extreme_mode(elements, overdamped_limit, scattered, stop).y);
  }
  return stop.stop_requested() ? dt_limit_bound(method, elements) : least;
}

std::vector<ElementOperator> extreme_operators(const Model& model, const scene::Scene& scene) {
  std::vector<ElementOperator> list;
  if (!scene.keys.empty())
    for (const scene::Scene& extreme : scene::extremes(scene))
      if (const Result<Model> built = build(extreme))
        list.emplace_back(*built, extreme, built->rest_position);
  if (list.empty()) list.emplace_back(model, scene, model.rest_position);
  return list;
}

double dt_limit_bound(Method method, const Model& model, const scene::Scene& scene) {
  double least = no_limit;
  for (const ElementOperator& elements : extreme_operators(model, scene))
    least = std::min(least, dt_limit_bound(method, elements));
  return least;
}

double dt_limit(Method method, const Model& model, const scene::Scene& scene, const std::stop_token& stop) {
  double least = no_limit;
  for (const ElementOperator& elements : extreme_operators(model, scene))
    least = std::min(least, dt_limit(method, elements, stop));
  return least;
}

double dt_limit_bound(const Model& model, const scene::Scene& scene) {
  return dt_limit_bound(scene.solver.method, model, scene);
}

double dt_limit(const Model& model, const scene::Scene& scene) {
  return dt_limit(scene.solver.method, model, scene);
}

double dt_limit_if_near(const Model& model, const scene::Scene& scene) {
  const double bound = dt_limit_bound(model, scene);
  return scene.solver.dt > margin_to_warn * bound ? dt_limit(model, scene) : bound;
}

std::optional<double> margin(double dt, double limit) {
  if (limit == no_limit || limit <= 0.0) return std::nullopt;
  return dt / limit;
}

std::string step_warning(const scene::Solver& solver, double limit) {
  const std::string method = scene::name(solver.method);
  if (limit <= 0.0)
    return method +
           " without damping is stable at no step: whatever dt is, the cloth will blow up; "
           "use symplectic_euler, which costs the same and is stable below its limit";
  const std::optional<double> share = margin(solver.dt, limit);
  if (!share || *share <= margin_to_warn) return {};
  if (*share <= 1.0)
    return formatted(
        "dt = %.4g s is %.0f %% of %.4g s, the longest stable step of %s for this stiffness and "
        "mass; stay below 90 %%",
        solver.dt, 100.0 * *share, limit, method.c_str());
  return formatted(
      "dt = %.4g s is beyond %.4g s, the longest stable step of %s for this stiffness and mass: "
      "the cloth will blow up",
      solver.dt, limit, method.c_str());
}

}  // namespace clothlab::model
