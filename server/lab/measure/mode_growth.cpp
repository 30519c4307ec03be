#include "server/lab/measure/mode_growth.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "server/model/stability.h"

namespace clothlab::lab {

namespace {

using scene::Method;

/// The two roots s of s^2 + damping s + omega^2 = 0, times dt; the root farther from 0 comes first.
std::pair<std::complex<double>, std::complex<double>> roots(const model::Mode& mode, double dt) {
  const double half = 0.5 * mode.damping;
  const std::complex<double> spread = std::sqrt(std::complex<double>(half * half - mode.omega_squared));
  return {dt * (-half - spread), dt * (-half + spread)};
}

/// Explicit Euler's and RK4's factor on the amplitude in one step, for w = s dt.
std::complex<double> explicit_factor(const std::complex<double>& w) {
  return 1.0 + w;
}
std::complex<double> rk4_factor(const std::complex<double>& w) {
  return 1.0 + w * (1.0 + w / 2.0 * (1.0 + w / 3.0 * (1.0 + w / 4.0)));
}

/// Symplectic Euler's factor l solves l^2 - (2 - q - d) l + 1 - d = 0, with q = omega^2 dt^2 and d = damping
/// dt: the damping uses the velocity of the step before. Beyond the limit, q + 2 d > 4, one root lies below
/// -1; returns its absolute value.
double symplectic_factor(double q, double d) {
  const double half_trace = 0.5 * (2.0 - q - d);
  return -half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - (1.0 - d)));
}

/// Verlet's factor l solves l^3 - (2 - q - 3/2 d) l^2 + (1 - 2 d) l + d / 2 = 0. The three unknowns are the
/// position, the velocity in the middle of the step, and the velocity predicted for the damping. Beyond the
/// limit, q + 4 d > 4, one root lies below -1; returns its absolute value, found by bisection.
double verlet_factor(double q, double d) {
  const auto value = [&](double l) {
    return ((l - (2.0 - q - 1.5 * d)) * l + (1.0 - 2.0 * d)) * l + 0.5 * d;
  };
  double inside = 1.0, outside = 4.0 + q + 2.0 * d;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (inside + outside);
    (value(-middle) > 0.0 ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

double growth_a_step(Method method, const model::Mode& mode, double dt) {
  const double limit = model::dt_limit(method, mode);
  if (!(dt > limit)) return 0.0;
  const double q = mode.omega_squared * dt * dt, d = mode.damping * dt;
  const auto [far, near] = roots(mode, dt);
  const double factor = [&, far = far, near = near] {
    switch (method) {
      case Method::explicit_euler:
        return std::max(std::abs(explicit_factor(far)), std::abs(explicit_factor(near)));
      case Method::rk4:
        return std::max(std::abs(rk4_factor(far)), std::abs(rk4_factor(near)));
      case Method::symplectic_euler:
        return symplectic_factor(q, d);
      case Method::verlet:
        return verlet_factor(q, d);
      case Method::implicit_euler:
      case Method::pbd:
      case Method::xpbd:
      case Method::vbd:
      case Method::bdf2:
        break;  // stable at any step
    }
    return 1.0;
  }();
  return std::max(0.0, std::log(factor));
}

double shortest_visible(Method method, const model::Mode& mode, int steps, double e_folds) {
  const double limit = model::dt_limit(method, mode);
  if (limit == model::no_limit) return model::no_limit;
  const auto shows = [&](double dt) { return growth_a_step(method, mode, dt) * steps >= e_folds; };
  double hidden = limit, shown = limit > 0.0 ? limit : 1e-3 / std::sqrt(mode.omega_squared);
  while (!shows(shown)) {
    hidden = shown;
    shown *= 2.0;
    if (!(shown < 1e12)) return model::no_limit;
  }
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (hidden + shown);
    (shows(middle) ? shown : hidden) = middle;
  }
  return shown;
}

}  // namespace clothlab::lab
