#include "server/mesh/shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <utility>

#include "server/mesh/sides.h"

namespace clothlab::mesh {

namespace {

using glm::dvec2;
using glm::dvec3;

constexpr double end_share = 0.03;  // of the extent

double length_of(const std::vector<std::uint32_t>& border, const Mesh& mesh) {
  double length = 0.0;
  for (std::size_t i = 0; i < border.size(); ++i)
    length += glm::distance(mesh.vertices[border[i]], mesh.vertices[border[(i + 1) % border.size()]]);
  return length;
}

/// Walks along edges of one triangle, each from its start to its end, which triangles of one side outside
/// have in the same sense all round.
std::vector<std::vector<std::uint32_t>> borders_of(const std::vector<Side>& sides) {
  std::multimap<std::uint32_t, std::uint32_t> next;
  each_edge(sides, [&](std::size_t begin, std::size_t end) {
    const Side& side = sides[begin];
    if (end == begin + 1)
      next.emplace(side.forward ? side.low : side.high, side.forward ? side.high : side.low);
  });
  std::vector<std::vector<std::uint32_t>> borders;
  while (!next.empty()) {
    std::vector<std::uint32_t> border;
    for (auto at = next.begin(); at != next.end();) {
      border.push_back(at->first);
      const std::uint32_t to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    borders.push_back(std::move(border));
  }
  return borders;
}

}  // namespace

Shape shape_of(const Mesh& mesh) {
  Shape shape;
  for (const auto& [a, b, c] : mesh.triangles) {
    const dvec3 p = mesh.vertices[a];
    shape.area += 0.5 * glm::length(glm::cross(mesh.vertices[b] - p, mesh.vertices[c] - p));
  }
  for (const auto& [a, b, c] : mesh.texture) {
    const dvec2 u = b - a, v = c - a;
    shape.pattern_area += 0.5 * std::abs(u.x * v.y - u.y * v.x);
  }
  const std::vector<Side> sides = sides_of(mesh.triangles);
  std::size_t edges = 0;
  each_edge(sides, [&](std::size_t begin, std::size_t) {
    shape.mean_edge += glm::distance(mesh.vertices[sides[begin].low], mesh.vertices[sides[begin].high]);
    ++edges;
  });
  if (edges > 0) shape.mean_edge /= static_cast<double>(edges);
  shape.borders = borders_of(sides);
  std::stable_sort(shape.borders.begin(), shape.borders.end(), [&](const auto& one, const auto& other) {
    return length_of(one, mesh) > length_of(other, mesh);
  });
  for (int axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(),
                            [axis](const dvec3& a, const dvec3& b) { return a[axis] < b[axis]; });
    const double from = (*high)[axis] - end_share * ((*high)[axis] - (*low)[axis]);
    for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i)
      if (mesh.vertices[i][axis] >= from) shape.ends[static_cast<std::size_t>(axis)].push_back(i);
  }
  return shape;
}

std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& vertices, std::size_t most) {
  if (vertices.size() <= most) return vertices;
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < most; ++i) chosen.push_back(vertices[i * vertices.size() / most]);
  return chosen;
}

}  // namespace clothlab::mesh
