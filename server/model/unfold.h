// Triangles at rest and their neighbours, laid out side by side in one plane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

namespace clothlab::model {

using glm::dvec2;

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// A triangle at rest, laid flat: its corners counter-clockwise [m], x along the warp and y along the weft.
using FlatTriangle = std::array<dvec2, 3>;

/// The triangle on the other side of an edge, and the number of its corner opposite the edge.
struct Neighbour {
  std::uint32_t triangle = 0;
  int corner = 0;
};
/// For each edge of a triangle, by the number of the corner opposite it.
using Neighbours = std::vector<std::array<std::optional<Neighbour>, 3>>;

/// Who is beside whom. An edge of one triangle, or of more than two, has no neighbour.
Neighbours neighbours(const Triangles& triangles);

/// Twice the area of the triangle that the vectors span [m^2], positive if `b` is to the left of `a`.
inline double cross(const dvec2& a, const dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// A triangle laid out beside others in one plane.
struct Placed {
  std::array<std::uint32_t, 3> vertices{};
  FlatTriangle corners{};
};

/// Unfolds `triangle`, whose own rest shape is `flat`, across the edge that it shares with `from`: its corner
/// `corner` comes to lie on the side of the edge where `from` is not.
Placed unfolded(const Placed& from, std::size_t from_corner, const std::array<std::uint32_t, 3>& triangle,
                const FlatTriangle& flat, std::size_t corner);

}  // namespace clothlab::model
