// Counts where cloth passes through cloth: edges that cross triangles, by brute force over all pairs in
// double precision.
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <set>
#include <utility>
#include <vector>

#include "server/model/model.h"

namespace clothlab::test {

struct Crossing {
  std::pair<std::uint32_t, std::uint32_t> edge;
  std::uint32_t triangle = 0;
};

/// The edges of the model's triangles, each once.
inline std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_of(const model::Model& model) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& [a, b, c] : model.triangles)
    for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
      edges.insert({std::min(p, q), std::max(p, q)});
  return {edges.begin(), edges.end()};
}

/// Six times the volume of the tetrahedron a b c d; its sign tells on which side of the plane a b c the point
/// d lies.
inline double volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(glm::cross(b - a, c - a), d - a);
}

/// True if the segment p q passes through the inside of the triangle a b c; touching does not count.
inline bool crosses(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& a, const glm::dvec3& b,
                    const glm::dvec3& c) {
  const double above = volume(a, b, c, p), below = volume(a, b, c, q);
  if (!(above * below < 0.0)) return false;
  const double ab = volume(p, q, a, b), bc = volume(p, q, b, c), ca = volume(p, q, c, a);
  return (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
}

/// Number of crossings in the shape `x` [vertex_count] [m]; an edge and a triangle that share a vertex do not
/// count.
template <class Vec3>
std::vector<Crossing> crossings(const model::Model& model, const std::vector<Vec3>& x) {
  struct Box {
    glm::dvec3 low, high;
  };
  const auto at = [&](std::uint32_t i) { return glm::dvec3(x[i]); };
  std::vector<Box> boxes;
  for (const auto& [a, b, c] : model.triangles)
    boxes.push_back({glm::min(at(a), glm::min(at(b), at(c))), glm::max(at(a), glm::max(at(b), at(c)))});
  std::vector<Crossing> found;
  for (const auto& [i, j] : edges_of(model)) {
    const glm::dvec3 p = at(i), q = at(j), low = glm::min(p, q), high = glm::max(p, q);
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
      if (glm::any(glm::greaterThan(low, boxes[t].high)) || glm::any(glm::lessThan(high, boxes[t].low)))
        continue;
      const auto& [a, b, c] = model.triangles[t];
      if (i == a || i == b || i == c || j == a || j == b || j == c) continue;
      if (crosses(p, q, at(a), at(b), at(c))) found.push_back({{i, j}, t});
    }
  }
  return found;
}

}  // namespace clothlab::test
