#include "server/model/slope_form.h"

#include <cmath>

namespace clothlab::model {

std::array<double, 3> slopes(const FlatTriangle& corners, const dvec2& direction) {
  const double twice_area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec2 side = corners[(i + 2) % 3] - corners[(i + 1) % 3];
    result[i] = (-side.y * direction.x + side.x * direction.y) / twice_area;
  }
  return result;
}

void make_exact(Form& slope, const Nodes& nodes, const std::vector<std::size_t>& patch, const dvec2& middle,
                const dvec2& normal, double unit) {
  constexpr std::size_t conditions = 6, linear = 3;
  constexpr double hardly = 0.1;  // share of a condition that the others leave to it
  std::array<std::array<double, 8>, conditions> condition{};
  std::array<double, conditions> lacking{0.0, normal.x / unit, normal.y / unit, 0.0, 0.0, 0.0};
  for (std::size_t n = 0; n < patch.size(); ++n) {
    const dvec2 at = (nodes.place[patch[n]] - middle) / unit;
    const std::array<double, conditions> values{1.0, at.x, at.y, at.x * at.x, at.y * at.y, at.x * at.y};
    for (std::size_t c = 0; c < conditions; ++c) {
      condition[c][n] = values[c];
      lacking[c] -= values[c] * slope[patch[n]];
    }
  }
  // Gram-Schmidt: the change is a sum of orthonormal directions, each fixed by one more condition.
  const auto dot = [&](const auto& a, const auto& b) {
    double sum = 0.0;
    for (std::size_t n = 0; n < patch.size(); ++n) sum += a[n] * b[n];
    return sum;
  };
  std::array<double, conditions> whole{};
  for (std::size_t c = 0; c < conditions; ++c) whole[c] = std::sqrt(dot(condition[c], condition[c]));
  std::array<double, 8> change{};
  std::vector<std::size_t> open{0, 1, 2, 3, 4, 5};
  for (std::size_t taken = 0; !open.empty(); ++taken) {
    // `condition[c]` has become what is left of it beside the directions taken so far.
    const auto left = [&](std::size_t c) { return std::sqrt(dot(condition[c], condition[c])) / whole[c]; };
    auto next = open.begin();
    if (taken >= linear)
      next = std::max_element(open.begin(), open.end(), [&](auto a, auto b) { return left(a) < left(b); });
    const std::size_t c = *next;
    const double size = std::sqrt(dot(condition[c], condition[c]));
    if (!(size > hardly * whole[c])) break;
    open.erase(next);
    std::array<double, 8> direction = condition[c];
    for (double& component : direction) component /= size;
    const double share = lacking[c] / size;
    for (std::size_t n = 0; n < patch.size(); ++n) change[n] += share * direction[n];
    for (const std::size_t other : open) {
      const double common = dot(condition[other], direction);
      lacking[other] -= common * share;
      for (std::size_t n = 0; n < patch.size(); ++n) condition[other][n] -= common * direction[n];
    }
  }
  for (std::size_t n = 0; n < patch.size(); ++n) slope[patch[n]] += change[n];
}

}  // namespace clothlab::model
