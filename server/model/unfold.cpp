#include "server/model/unfold.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace clothlab::model {

using Index = std::uint32_t;

Neighbours neighbours(const Triangles& triangles) {
  struct Side {
    Index low, high, triangle;
    int corner;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (Index t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles[t][(i + 1) % 3], triangles[t][(i + 2) % 3]);
      sides.push_back({low, high, t, i});
    }
  const auto edge = [](const Side& side) { return std::pair(side.low, side.high); };
  std::stable_sort(sides.begin(), sides.end(),
                   [&](const Side& a, const Side& b) { return edge(a) < edge(b); });
  Neighbours result(triangles.size());
  for (std::size_t first = 0, end; first < sides.size(); first = end) {
    for (end = first + 1; end < sides.size() && edge(sides[end]) == edge(sides[first]);) ++end;
    if (end - first != 2) continue;
    const Side &a = sides[first], &b = sides[first + 1];
    result[a.triangle][static_cast<std::size_t>(a.corner)] = Neighbour{b.triangle, b.corner};
    result[b.triangle][static_cast<std::size_t>(b.corner)] = Neighbour{a.triangle, a.corner};
  }
  return result;
}

Placed unfolded(const Placed& from, std::size_t from_corner, const std::array<Index, 3>& triangle,
                const FlatTriangle& flat, std::size_t corner) {
  const std::size_t first = (corner + 1) % 3, second = (corner + 2) % 3;
  Placed placed{triangle, {}};
  for (const std::size_t end : {first, second})
    for (std::size_t k = 0; k < 3; ++k)
      if (from.vertices[k] == triangle[end]) placed.corners[end] = from.corners[k];
  const dvec2 own_edge = flat[second] - flat[first], own_apex = flat[corner] - flat[first];
  const double length = glm::length(own_edge);
  const double along = glm::dot(own_apex, own_edge) / length,
               height = std::abs(cross(own_edge, own_apex)) / length;
  const dvec2 edge = glm::normalize(placed.corners[second] - placed.corners[first]), left(-edge.y, edge.x);
  const bool from_is_left = glm::dot(from.corners[from_corner] - placed.corners[first], left) > 0.0;
  placed.corners[corner] = placed.corners[first] + along * edge + (from_is_left ? -height : height) * left;
  return placed;
}

}  // namespace clothlab::model
