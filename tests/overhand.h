// A ribbon with an overhand knot in it, still loose, as a triangle mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <vector>

namespace clothlab::test {

/// `row` is along the ribbon: the vertices of a row are row * across + 0 ... across - 1, from z = 0 upwards.
struct Ribbon {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int rows = 0, across = 0;
};

/// The middle line from above: x = t^3 - 3 t, y = t^4 - 4 t^2 crosses itself three times (a long trefoil,
/// after Shastri 1992), and so that over and under take turns. From `knot_end` on it goes straight on.
inline constexpr double knot_end = 2.05;
inline glm::dvec3 overhand(double t, double rise) {
  constexpr std::array<std::array<double, 2>, 5> heights{
      {{0.0, 0.0}, {0.518, 1.0}, {1.732, -1.0}, {1.932, 1.0}, {knot_end, 0.6}}};
  const double side = t < 0.0 ? -1.0 : 1.0, u = std::min(std::abs(t), knot_end);
  std::size_t i = 0;
  while (i + 2 < heights.size() && u > heights[i + 1][0]) ++i;
  const double share = (u - heights[i][0]) / (heights[i + 1][0] - heights[i][0]);
  const double smooth = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
  const double height = heights[i][1] + smooth * (heights[i + 1][1] - heights[i][1]);
  glm::dvec3 place(u * u * u - 3 * u, u * u * u * u - 4 * u * u, rise * height);
  if (std::abs(t) > knot_end) {
    const glm::dvec3 tangent(3 * u * u - 3, 4 * u * u * u - 8 * u, 0.0);
    place += (std::abs(t) - knot_end) * tangent;
  }
  return {side * place.x, place.y, side * place.z};
}

/// A ribbon on edge along that line, `width` wide [m], of which a unit of the line is `unit` [m], with rows
/// about `spacing` [m] apart. Crossing strands are 0.6 of the width apart.
inline Ribbon overhand_ribbon(double unit, double width, double spacing, int across) {
  const double rise = 0.8 * width / unit, tail = 0.5;
  std::vector<glm::dvec3> line;  // walked in small steps, a row every `spacing`
  double walked = spacing;
  glm::dvec3 before = unit * overhand(-knot_end - tail, rise);
  for (double t = -knot_end - tail; t <= knot_end + tail; t += 1e-4) {
    const glm::dvec3 place = unit * overhand(t, rise);
    walked += glm::distance(place, before);
    before = place;
    if (walked < spacing) continue;
    walked -= spacing;
    line.push_back(place);
  }
  Ribbon ribbon;
  ribbon.rows = static_cast<int>(line.size());
  ribbon.across = across;
  for (const glm::dvec3& place : line)
    for (int i = 0; i < across; ++i)
      ribbon.vertices.push_back(place + glm::dvec3(0.0, 0.0, width * (i / (across - 1.0) - 0.5)));
  const auto n = static_cast<std::uint32_t>(across);
  for (std::uint32_t row = 0; row + 1 < static_cast<std::uint32_t>(ribbon.rows); ++row)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t v = row * n + i;
      ribbon.triangles.push_back({v, v + n, v + n + 1});
      ribbon.triangles.push_back({v, v + n + 1, v + 1});
    }
  return ribbon;
}

}  // namespace clothlab::test
