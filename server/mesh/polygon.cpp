// Polygons to triangles. A quad is cut along its shorter diagonal that lies inside it; other polygons lose an
// ear at a time (Meisters 1975), of all ears the one with the shortest cut.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "server/mesh/raw.h"

namespace clothlab::mesh {

namespace {

using glm::dvec2;
using glm::dvec3;

/// A triangle whose height is below this share of its longest edge has no area that 32-bit floats can see.
constexpr double least_height = 1e-7;

double cross(const dvec2& a, const dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Twice the area; positive if the corners run counter-clockwise.
double area(const dvec2& a, const dvec2& b, const dvec2& c) {
  return cross(b - a, c - a);
}

bool is_flat(const dvec2& a, const dvec2& b, const dvec2& c) {
  const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return !(area(a, b, c) > least_height * longest);
}

/// The polygon in the plane that it nearly lies in, counter-clockwise. Empty: it has no area.
std::vector<dvec2> flattened(const std::vector<dvec3>& corners) {
  dvec3 normal(0.0);  // Newell's
  for (std::size_t i = 0; i < corners.size(); ++i)
    normal += glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
  const double length = glm::length(normal);
  if (!(length > 0.0)) return {};
  normal /= length;
  const dvec3 side = glm::normalize(std::abs(normal.x) < 0.5 ? glm::cross(normal, dvec3(1, 0, 0))
                                                             : glm::cross(normal, dvec3(0, 1, 0)));
  const dvec3 up = glm::cross(normal, side);
  std::vector<dvec2> flat;
  for (const dvec3& corner : corners)
    flat.emplace_back(glm::dot(corner - corners[0], side), glm::dot(corner - corners[0], up));
  return flat;
}

}  // namespace

bool has_no_area(const dvec3& a, const dvec3& b, const dvec3& c) {
  const double longest = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
  return !(glm::length(glm::cross(b - a, c - a)) > least_height * longest);
}

std::string triangulate(const std::vector<dvec3>& corners,
                        std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& budget) {
  const std::vector<dvec2> flat = flattened(corners);
  if (flat.empty()) return "a polygon without area";
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  while (left.size() > 3) {
    const std::size_t count = left.size();
    const auto at = [&](std::size_t i) { return left[i % count]; };
    std::size_t best = count;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t a = at(i + count - 1), b = at(i), c = at(i + 1);
      const dvec2 cut = flat[c] - flat[a];
      if (glm::dot(cut, cut) >= shortest || is_flat(flat[a], flat[b], flat[c])) continue;
      // The rest of a quad is a triangle, which must have an area too.
      if (count == 4 && is_flat(flat[a], flat[c], flat[at(i + 2)])) continue;
      if (budget < count) return "a polygon that is too intricate";
      budget -= count;
      bool empty = true;
      for (const std::uint32_t d : left)
        if (d != a && d != b && d != c && area(flat[a], flat[b], flat[d]) >= 0 &&
            area(flat[b], flat[c], flat[d]) >= 0 && area(flat[c], flat[a], flat[d]) >= 0)
          empty = false;
      if (!empty) continue;
      best = i;
      shortest = glm::dot(cut, cut);
    }
    if (best == count) return "a polygon that crosses itself or is folded flat";
    triangles.push_back({at(best + count - 1), at(best), at(best + 1)});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({left[0], left[1], left[2]});
  return "";
}

void triangulate_folded(const std::vector<dvec3>& corners,
                        std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t& budget) {
  std::vector<std::uint32_t> left(corners.size());
  for (std::uint32_t i = 0; i < left.size(); ++i) left[i] = i;
  const auto flat = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return has_no_area(corners[a], corners[b], corners[c]);
  };
  while (left.size() > 3) {
    const std::size_t count = left.size();
    const auto at = [&](std::size_t i) { return left[i % count]; };
    std::size_t best = 1;
    double shortest = std::numeric_limits<double>::infinity();
    const bool search = budget >= count;  // else all cuts go from the first corner
    if (search) budget -= count;
    for (std::size_t i = 0; search && i < count; ++i) {
      const std::uint32_t a = at(i + count - 1), b = at(i), c = at(i + 1);
      const double cut = glm::distance(corners[a], corners[c]);
      if (cut >= shortest || flat(a, b, c) || (count == 4 && flat(a, c, at(i + 2)))) continue;
      best = i;
      shortest = cut;
    }
    triangles.push_back({at(best + count - 1), at(best), at(best + 1)});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({left[0], left[1], left[2]});
}

}  // namespace clothlab::mesh
