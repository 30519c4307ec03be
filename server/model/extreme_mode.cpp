#include "server/model/extreme_mode.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>

#include "server/model/small_eigen.h"

namespace clothlab::model {

namespace {

constexpr int most_iterations = 2000;
constexpr int patience = 10;             // iterations between two checks of progress
constexpr double least_progress = 1e-4;  // go on if the limit has fallen by this share since the last check
constexpr double rounding = 1e-7;        // a residual below this share of its terms counts as rounding error

double dot(const Field& a, const Field& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += glm::dot(a[i], b[i]);
  return sum;
}

/// A search direction y with its products K y and C y. All three are linear: a sum of directions adds each.
struct Direction {
  Field y, stiff, damped;
  explicit Direction(std::size_t count) : y(count), stiff(count), damped(count) {}

  /// Replaces this direction by a * this + b * other.
  void combine(double a, double b, const Direction& other) {
    for (std::size_t i = 0; i < y.size(); ++i) {
      y[i] = a * y[i] + b * other.y[i];
      stiff[i] = a * stiff[i] + b * other.stiff[i];
      damped[i] = a * damped[i] + b * other.damped[i];
    }
  }
  /// Scales y to length 1; false if y is too short for that.
  bool normalise() {
    const double length = std::sqrt(dot(y, y));
    if (!(length > 1e-30)) return false;
    combine(1.0 / length, 0.0, *this);
    return true;
  }
  /// Makes y perpendicular to the unit vectors `others` and of length 1; false if y lies in their span.
  bool orthonormalise(std::initializer_list<const Direction*> others) {
    if (!normalise()) return false;
    for (const Direction* other : others) combine(1.0, -dot(y, other->y), *other);
    const double left = std::sqrt(dot(y, y));
    return left > 1e-8 && normalise();
  }
};

/// The limit's negative slopes: to first order it falls as stiffness * y.Ky + damping * y.Cy rises.
struct Weights {
  double stiffness = 0, damping = 0;
};

Weights weights(const LimitOfMode& limit, const Mode& mode) {
  constexpr double share = 1e-5;
  const double omega_step = share * mode.omega_squared;
  const double damping_step = share * std::max(mode.damping, std::sqrt(mode.omega_squared));
  const double now = limit(mode);
  return {(now - limit({mode.omega_squared + omega_step, mode.damping})) / omega_step,
          (now - limit({mode.omega_squared, mode.damping + damping_step})) / damping_step};
}

}  // namespace

Field scattered_start(const ElementOperator& elements) {
  Field start(elements.vertex_count());
  std::uint64_t seed = 1;
  const auto next = [&seed] {  // Knuth's linear congruential generator
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(seed >> 11) * 0x1p-53 - 0.5;
  };
  for (std::size_t i = 0; i < start.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) start[i][axis] = elements.pinned(i) ? 0.0 : next();
  return start;
}

ExtremeMode extreme_mode(const ElementOperator& elements, const LimitOfMode& limit, Field start,
                         const std::stop_token& stop) {
  const std::size_t count = start.size();
  Direction best(count), residual(count), last(count);
  best.y = std::move(start);
  elements.apply(best.y, best.stiff, best.damped);
  ExtremeMode found;
  if (!best.normalise()) return found;
  bool has_last = false;
  double limit_before = std::numeric_limits<double>::infinity();
  while (found.iterations < most_iterations && !stop.stop_requested()) {
    found.mode = {dot(best.y, best.stiff), dot(best.y, best.damped)};
    const double limit_now = limit(found.mode);
    if (!std::isfinite(limit_now) || limit_now <= 0.0) break;
    if (found.iterations % patience == 0) {
      if (limit_before - limit_now < least_progress * limit_now) break;
      limit_before = limit_now;
    }
    ++found.iterations;

    const Weights weight = weights(limit, found.mode);
    const auto image = [&](const Direction& of, std::size_t i) {
      return weight.stiffness * of.stiff[i] + weight.damping * of.damped[i];
    };
    const double level = weight.stiffness * found.mode.omega_squared + weight.damping * found.mode.damping;
    for (std::size_t i = 0; i < count; ++i) residual.y[i] = image(best, i) - level * best.y[i];
    // A residual that is only rounding error gives no direction. The limit could still fall by its square.
    const double terms = std::abs(weight.stiffness) * std::sqrt(dot(best.stiff, best.stiff)) +
                         std::abs(weight.damping) * std::sqrt(dot(best.damped, best.damped));
    if (dot(residual.y, residual.y) <= rounding * rounding * terms * terms) break;
    elements.apply(residual.y, residual.stiff, residual.damped);
    if (!residual.orthonormalise({&best})) break;
    has_last = has_last && last.orthonormalise({&best, &residual});

    // The best vector in the plane, or space, that the directions span: the largest eigenvector there.
    const Direction* basis[3] = {&best, &residual, &last};
    const int size = has_last ? 3 : 2;
    glm::dmat3 matrix(0.0);
    for (int row = 0; row < size; ++row)
      for (int column = row; column < size; ++column) {
        double sum = 0.0;
        for (std::size_t i = 0; i < count; ++i) sum += glm::dot(basis[row]->y[i], image(*basis[column], i));
        matrix[row][column] = matrix[column][row] = sum;
      }
    if (!has_last) matrix[2][2] = -1e300;  // keeps the unused axis out of the largest eigenvector
    const glm::dvec3 share = largest_eigenpair(matrix).vector;
    if (has_last)
      last.combine(share[2], share[1], residual);
    else {
      last = residual;
      last.combine(share[1], 0.0, last);
    }
    best.combine(share[0], 1.0, last);
    best.normalise();
    has_last = true;
  }
  found.mode = {dot(best.y, best.stiff), dot(best.y, best.damped)};
  found.y = std::move(best.y);
  return found;
}

}  // namespace clothlab::model
