// The sides of triangles, sorted by their edges. Internal to server/mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace clothlab::mesh {

/// A side of a triangle.
struct Side {
  std::uint32_t low, high;  ///< its vertices
  std::uint32_t triangle;   ///< whose side it is
  bool forward;             ///< the triangle goes from `low` to `high`
  bool operator<(const Side& other) const {
    return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
  }
  bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
};

inline std::vector<Side> sides_of(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t a = triangles[i][corner], b = triangles[i][(corner + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), i, a < b});
    }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Calls visit(begin, end) for the sides at each edge: [begin, end) of `sides`, which are sorted.
template <class Visit>
void each_edge(const std::vector<Side>& sides, Visit&& visit) {
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    for (end = begin; end < sides.size() && sides[end].same_edge(sides[begin]);) ++end;
    visit(begin, end);
  }
}

}  // namespace clothlab::mesh
