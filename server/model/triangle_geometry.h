// A triangle's normal, the corner opposite to an edge, and the place that is nearest to a point.
#pragma once

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "server/model/orientation.h"

namespace clothlab::model {

inline constexpr double no_distance = 1e-12;  ///< less has no direction [m]

/// Unit normal; 0 for a triangle without area.
inline dvec3 normal_of(const std::array<dvec3, 3>& corner) {
  const dvec3 across = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double length = glm::length(across);
  return length > 0.0 ? across / length : dvec3(0.0);
}

/// The corner of a triangle that is on neither end of its edge from `a` to `b`.
template <class Index>
Index opposite(const std::array<Index, 3>& triangle, Index a, Index b) {
  return *std::find_if(triangle.begin(), triangle.end(),
                       [&](Index corner) { return corner != a && corner != b; });
}

struct PlaceOnTriangle {
  dvec3 place;   ///< [m]
  dvec3 shares;  ///< of the corners, each 0 or more, in sum 1
};

/// Follows Ericson 2005, "Real-Time Collision Detection", section 5.1.5.
inline PlaceOnTriangle nearest_place(const std::array<dvec3, 3>& corner, const dvec3& point) {
  const auto& [a, b, c] = corner;
  const auto of = [&](double u, double v, double w) {
    return PlaceOnTriangle{u * a + v * b + w * c, {u, v, w}};
  };
  const dvec3 ab = b - a, ac = c - a, ap = point - a, bp = point - b, cp = point - c;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return of(1.0, 0.0, 0.0);
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return of(0.0, 1.0, 0.0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return of(1.0 - d1 / (d1 - d3), d1 / (d1 - d3), 0.0);
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return of(0.0, 0.0, 1.0);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return of(1.0 - d2 / (d2 - d6), 0.0, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return of(0.0, 1.0 - w, w);
  }
  const double sum = va + vb + vc;
  return of(va / sum, vb / sum, vc / sum);
}

}  // namespace clothlab::model
