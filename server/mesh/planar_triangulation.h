// Delaunay triangulation of points in a plane, with edges that it must have: points one after another, with
// flips of edges (Lawson 1977, "Software for C1 surface interpolation"); missing edges by flips along them
// (Sloan 1993, "A fast algorithm for generating constrained Delaunay triangulations").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace clothlab::mesh {

using glm::dvec2;

/// Twice the area of a triangle, above 0 where it turns from x to y.
inline double doubled_area(const dvec2& a, const dvec2& b, const dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The sine of the least angle of a triangle that turns from x to y; 0 or less without area, or turned over.
double least_sine(const dvec2& a, const dvec2& b, const dvec2& c);

class PlanarTriangulation {
 public:
  /// Of points from `low` to `high`.
  PlanarTriangulation(const dvec2& low, const dvec2& high);

  /// Adds a point, no other one's place, and returns its number. Required edges stay.
  std::uint32_t add(const dvec2& point);
  /// Makes two points an edge that stays. False: another required edge is in the way.
  bool require(std::uint32_t a, std::uint32_t b);
  /// Moves points that are on no required edge to the middle of the triangles around them, `rounds` times,
  /// where that leaves no worse angle (Laplacian smoothing with a guard; Freitag 1997), with flips in
  /// between.
  void smooth(int rounds);

  /// The triangles from outside of which one gets by an odd number of required edges, by points' numbers.
  std::vector<std::array<std::uint32_t, 3>> inside() const;
  std::vector<dvec2> points() const { return {points_.begin() + 3, points_.end()}; }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Triangle {
    std::array<std::uint32_t, 3> corners{};
    std::array<std::uint32_t, 3> beside{none, none, none};  ///< across from each corner
    std::array<bool, 3> required{};                         ///< the edge across from each corner
  };

  std::uint32_t find(const dvec2& point) const;
  void split(std::uint32_t triangle, std::uint32_t point);
  std::size_t corner_of(std::uint32_t triangle, std::uint32_t point) const;
  std::size_t side_towards(std::uint32_t triangle, std::uint32_t other) const;
  void connect(std::uint32_t triangle, std::size_t side, std::uint32_t other, bool required);
  bool can_flip(std::uint32_t triangle, std::size_t side) const;
  bool should_flip(std::uint32_t triangle, std::size_t side) const;
  void flip(std::uint32_t triangle, std::size_t side);
  void restore(std::vector<std::uint32_t> changed);
  /// The triangles around a point, each once.
  std::vector<std::uint32_t> around(std::uint32_t point) const;
  bool improve(std::uint32_t point);

  std::vector<dvec2> points_;  ///< the first three: of a triangle around all others
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> at_;  ///< a triangle at each point
  std::vector<char> held_;         ///< whether a point is on a required edge
  mutable std::uint32_t last_ = 0;
};

}  // namespace clothlab::mesh
