// Places where borders of a mesh lie together and are not joined: cloth comes apart there.
#include "server/mesh/open_places.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "server/base/text.h"
#include "server/mesh/place_grid.h"

namespace clothlab::mesh {

namespace {

using glm::dvec3;
using Index = std::uint32_t;

/// Borders nearer than this share of their sides are meant to be one: it is what rounding to three digits
/// makes, and layers that lie on each other are some times that apart.
constexpr double near_share = 1e-3;
constexpr std::size_t most_open_looks = 50'000'000;
constexpr std::size_t most_listed = 1u << 20;

class Search {
 public:
  Search(const std::vector<dvec3>& vertices, const std::vector<std::array<Index, 3>>& triangles,
         const std::vector<Side>& sides)
      : vertices_(vertices), triangles_(triangles) {
    each_edge(sides, [&](std::size_t begin, std::size_t end) {
      if (end - begin == 1) border_.push_back(sides[begin]);
    });
  }

  /// Those that are no farther than `reach` from the edge.
  std::vector<CornerOnEdge> list(double reach) {
    if (border_.empty()) return {};
    const PlaceGrid grid = border_places();
    std::size_t budget = most_open_looks;
    listed_within_ = reach;
    for (const Side& edge : border_)
      if (!look_at_edge(grid, edge, budget) || listed_.size() > most_listed) break;
    std::sort(listed_.begin(), listed_.end(),
              [](const CornerOnEdge& a, const CornerOnEdge& b) { return a.triangle < b.triangle; });
    return std::move(listed_);
  }

  OpenPlaces run() {
    if (border_.empty()) return {};
    const PlaceGrid grid = border_places();
    std::size_t budget = most_open_looks;
    for (const Index i : on_border_)
      if (!look_at_corner(grid, i, budget)) return found_;
    for (const Side& edge : border_)
      if (!look_at_edge(grid, edge, budget)) return found_;
    return found_;
  }

 private:
  PlaceGrid border_places() {
    list_border_vertices();
    PlaceGrid grid(mean_);
    for (const Index i : on_border_) grid.add(i, vertices_[i]);
    return grid;
  }

  void list_border_vertices() {
    shortest_.assign(vertices_.size(), std::numeric_limits<double>::infinity());
    triangle_.assign(vertices_.size(), 0);
    double sum = 0.0;
    for (const Side& edge : border_) {
      const double length = glm::distance(vertices_[edge.low], vertices_[edge.high]);
      sum += length;
      for (const Index end : {edge.low, edge.high}) {
        if (!std::isfinite(shortest_[end])) on_border_.push_back(end);
        if (!(shortest_[end] <= length)) shortest_[end] = length;
        triangle_[end] = edge.triangle;
      }
    }
    std::sort(on_border_.begin(), on_border_.end());
    mean_ = std::max(sum / static_cast<double>(border_.size()), std::numeric_limits<double>::min());
  }

  bool look_at_corner(const PlaceGrid& grid, Index i, std::size_t& budget) {
    const double reach = near_share * shortest_[i];
    const dvec3& place = vertices_[i];
    return grid.near(place - reach, place + reach, budget, [&](Index other) {
      const double gap = glm::distance(place, vertices_[other]);
      if (other >= i || gap > std::min(reach, near_share * shortest_[other])) return;
      if (found_.corners++ == 0) found_.corner = {triangle_[other], triangle_[i], gap};
      found_.widest = std::max(found_.widest, gap);
    });
  }

  bool look_at_edge(const PlaceGrid& grid, const Side& edge, std::size_t& budget) {
    const dvec3 &a = vertices_[edge.low], &b = vertices_[edge.high];
    const double length = glm::distance(a, b), reach = near_share * length;
    if (!(length > 0.0)) return true;
    return grid.near(glm::min(a, b) - reach, glm::max(a, b) + reach, budget, [&](Index i) {
      const auto& own = triangles_[edge.triangle];
      if (std::find(own.begin(), own.end(), i) != own.end()) return;
      const dvec3& place = vertices_[i];
      const double near = std::min(reach, near_share * shortest_[i]);
      if (glm::distance(place, a) <= reach || glm::distance(place, b) <= reach) return;
      const double share = glm::dot(place - a, b - a) / (length * length);
      const double gap = glm::distance(place, a + share * (b - a));
      if (!(share > 0.0 && share < 1.0 && gap <= near)) return;
      if (gap <= listed_within_) listed_.push_back({edge.triangle, i, edge.low, edge.high, share});
      if (found_.on_edges++ == 0) found_.on_edge = {triangle_[i], edge.triangle, gap};
    });
  }

  const std::vector<dvec3>& vertices_;
  const std::vector<std::array<Index, 3>>& triangles_;
  std::vector<Side> border_;
  std::vector<Index> on_border_, triangle_;
  std::vector<double> shortest_;  // side of the border at each of its vertices [m]
  double mean_ = 0.0;
  double listed_within_ = -1.0;
  std::vector<CornerOnEdge> listed_;
  OpenPlaces found_;
};

}  // namespace

OpenPlaces open_places(const std::vector<dvec3>& vertices, const std::vector<std::array<Index, 3>>& triangles,
                       const std::vector<Side>& sides) {
  return Search(vertices, triangles, sides).run();
}

std::vector<CornerOnEdge> corners_on_edges(const std::vector<dvec3>& vertices,
                                           const std::vector<std::array<Index, 3>>& triangles,
                                           const std::vector<Side>& sides, double reach) {
  return Search(vertices, triangles, sides).list(reach);
}

std::vector<std::string> notes_of(const OpenPlaces& open,
                                  const std::function<std::string(std::size_t triangle)>& place_of) {
  std::vector<std::string> notes;
  const auto lie = [](std::size_t count) {
    return formatted("%zu %s at its borders ", count, count == 1 ? "corner" : "corners") +
           (count == 1 ? "lies" : "lie");
  };
  const auto both = [&](const OpenPlaces::Place& place) {
    return place_of(place.triangle) + " and " + place_of(place.other);
  };
  if (open.corners > 0)
    notes.push_back(
        lie(open.corners) +
        formatted(" at the place of another, up to %.2g m from it, not joined with it, the first in ",
                  open.widest) +
        both(open.corner) + ": the mesh is open there; let the faces share their vertices");
  if (open.on_edges > 0)
    notes.push_back(
        lie(open.on_edges) +
        formatted(" on an edge that has no vertex there, the first, %.2g m from it, in ", open.on_edge.gap) +
        both(open.on_edge) + ": the mesh is open there; divide the edge at these corners");
  return notes;
}

}  // namespace clothlab::mesh
