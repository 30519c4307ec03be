// Each method's step limit for one vibration: the formulae, and the method's own growth on both sides of the
// limit.
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "server/model/stability.h"
#include "tests/catch.h"

using namespace clothlab;
using model::Mode;
using scene::Method;

namespace {

using State = std::array<double, 3>;  // x, v, and the velocity half a step ago, which Verlet carries

/// One step of x'' = -omega^2 x - damping x', as the method's kernel takes it.
State step(Method method, const Mode& mode, double dt, const State& state) {
  const auto [x, v, middle] = state;
  const auto force = [&](double at, double speed) { return -mode.omega_squared * at - mode.damping * speed; };
  const double a = force(x, v), h = dt / 2;
  if (method == Method::explicit_euler) return {x + dt * v, v + dt * a, 0.0};
  if (method == Method::symplectic_euler) return {x + dt * (v + dt * a), v + dt * a, 0.0};
  if (method == Method::verlet) return {x + dt * (middle + dt * a), middle + h * a + dt * a, middle + dt * a};
  const double v2 = v + h * a, a2 = force(x + h * v, v2);
  const double v3 = v + h * a2, a3 = force(x + h * v2, v3), v4 = v + dt * a3, a4 = force(x + dt * v3, v4);
  return {x + dt / 6 * (v + 2 * v2 + 2 * v3 + v4), v + dt / 6 * (a + 2 * a2 + 2 * a3 + a4), 0.0};
}

/// Long-term growth of the vibration per step, as a logarithm, from repeated squares of the step's matrix.
double growth(Method method, const Mode& mode, double dt) {
  glm::dmat3 matrix;
  for (int column = 0; column < 3; ++column) {
    State unit{};
    unit[static_cast<std::size_t>(column)] = 1.0;
    const State after = step(method, mode, dt, unit);
    matrix[column] = {after[0], after[1], after[2]};
  }
  double logarithm = 0.0, power = 1.0;
  for (int squaring = 0; squaring < 40; ++squaring) {
    double size = 0.0;
    for (int column = 0; column < 3; ++column) size += glm::length(matrix[column]);
    logarithm += std::log(size) / power;
    matrix = (matrix / size) * (matrix / size);
    power *= 2.0;
  }
  return logarithm;
}

}  // namespace

TEST_CASE("for one vibration the limits are those of the theory") {
  const double omega = 50.0;
  const auto limit = [&](Method method, double z) {
    return omega * model::dt_limit(method, {omega * omega, 2 * z * omega});
  };
  CHECK(limit(Method::symplectic_euler, 0.0) == Approx(2.0));
  CHECK(limit(Method::verlet, 0.0) == Approx(2.0));
  CHECK(limit(Method::rk4, 0.0) == Approx(2 * std::numbers::sqrt2));
  CHECK(limit(Method::explicit_euler, 0.0) == 0.0);
  for (const double z : {0.05, 0.3, 0.9}) {
    CHECK(limit(Method::explicit_euler, z) == Approx(2 * z));
    CHECK(limit(Method::symplectic_euler, z) == Approx(2 * (std::sqrt(1 + z * z) - z)));
    CHECK(limit(Method::verlet, z) == Approx(2 * (std::sqrt(1 + 4 * z * z) - 2 * z)));
  }
  // Solved by hand, to the given digits.
  CHECK(limit(Method::symplectic_euler, 0.1) == Approx(1.81).margin(0.005));
  CHECK(limit(Method::symplectic_euler, 1.0) == Approx(0.83).margin(0.005));
  CHECK(limit(Method::rk4, 0.1) == Approx(2.95).margin(0.005));
  CHECK(limit(Method::rk4, 0.5) == Approx(2.62).margin(0.005));
  CHECK(limit(Method::rk4, 1.0) == Approx(2.79).margin(0.006));
  for (const Method method : {Method::implicit_euler, Method::bdf2})
    CHECK(model::dt_limit(method, {1.0, 1.0}) == model::no_limit);
}

TEST_CASE(
    "just under its limit a method's own step shrinks a vibration, just over it grows, overdamped or not") {
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    for (const double z : {0.01, 0.1, 0.5, 0.7, 1.0, 1.5, 4.0, 100.0}) {
      const Mode mode{9.0, 6.0 * z};
      const double limit = model::dt_limit(method, mode);
      INFO("method " << static_cast<int>(method) << ", z " << z << ", limit " << limit);
      CHECK(growth(method, mode, 0.999 * limit) < 0.0);
      CHECK(growth(method, mode, 1.001 * limit) > 0.0);
    }
  }
}
