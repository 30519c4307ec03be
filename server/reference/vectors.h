// A vector for each vertex: sums and sizes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace clothlab::reference {

using Vectors = std::vector<glm::dvec3>;  ///< [vertex_count]

/// a + scale * b, vertex by vertex.
inline Vectors plus(const Vectors& a, double scale, const Vectors& b) {
  Vectors sum = a;
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += scale * b[i];
  return sum;
}

/// Length of the longest.
inline double largest(const Vectors& vectors) {
  double most = 0.0;
  for (const glm::dvec3& one : vectors) most = std::max(most, glm::length(one));
  return most;
}

}  // namespace clothlab::reference
