// The slope of a surface across an edge, as a linear form of the heights at the vertices around it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/model/unfold.h"

namespace clothlab::model {

/// The vertices around a triangle, laid out in its plane, and a number for each: a linear form of a field of
/// values at the vertices.
constexpr std::size_t most_nodes = 12;
using Form = std::array<double, most_nodes>;
struct Nodes {
  std::array<std::uint32_t, most_nodes> vertex{};
  std::array<dvec2, most_nodes> place{};
  std::size_t count = 0;

  /// The number of the vertex's node, which is made if needed. A vertex keeps its first place.
  std::size_t add(std::uint32_t which, const dvec2& where) {
    const auto end = vertex.begin() + static_cast<std::ptrdiff_t>(count);
    const auto found = std::find(vertex.begin(), end, which);
    if (found != end) return static_cast<std::size_t>(found - vertex.begin());
    vertex[count] = which;
    place[count] = where;
    return count++;
  }
};

/// Derivatives along `direction` of the three functions that are linear on the triangle and 1 at one corner.
std::array<double, 3> slopes(const FlatTriangle& corners, const dvec2& direction);

/// Changes `slope` as little as possible (in the sum of squares) so that it is exact for every quadratic
/// function: the derivative along `normal` at `middle`. Only the nodes in `patch` take part; lengths are
/// measured in `unit`. Conditions that the patch can hardly meet are left out, the linear ones never.
void make_exact(Form& slope, const Nodes& nodes, const std::vector<std::size_t>& patch, const dvec2& middle,
                const dvec2& normal, double unit);

}  // namespace clothlab::model
