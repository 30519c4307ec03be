#include "server/model/untangle.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "server/base/disjoint_sets.h"
#include "server/base/pieces.h"
#include "server/model/box_tree.h"
#include "server/model/triangle_geometry.h"

namespace clothlab::model {

namespace {

using Index = std::uint32_t;

/// What edges that cross nothing hold together.
class Regions {
 public:
  Regions(const DressCloth& cloth, const std::vector<Crossing>& crossings)
      : sets_(cloth.x.size()), size_(cloth.x.size(), 0), border_(cloth.x.size(), false) {
    std::vector<DressCloth::Edge> cut;
    for (const Crossing& each : crossings) cut.push_back(each.edge);
    std::sort(cut.begin(), cut.end());
    for (const DressCloth::Edge& edge : cloth.edges)
      if (!std::binary_search(cut.begin(), cut.end(), edge)) sets_.join(edge[0], edge[1]);
    for (Index i = 0; i < cloth.x.size(); ++i) {
      ++size_[of(i)];
      if (cloth.on_border(i)) border_[of(i)] = true;
    }
  }
  Index of(Index vertex) { return sets_.find(vertex); }
  bool has_border(Index region) const { return border_[region]; }
  /// True if the first is the smaller one; of equal ones that with the larger number.
  bool smaller(Index one, Index other) const {
    return size_[one] != size_[other] ? size_[one] < size_[other] : one > other;
  }

 private:
  DisjointSets sets_;
  std::vector<Index> size_;
  std::vector<bool> border_;
};

/// A crossing, and of its edge's ends the one that is cut off.
struct Pair {
  const Crossing* crossing;
  std::optional<Index> cut_off;  ///< 0 or 1: the edge's end; none: both ends are in one region
  Index region = 0;              ///< that of this end
  Index contour = 0;
};

class Untangling {
 public:
  Untangling(const DressCloth& cloth, const std::vector<Crossing>& crossings)
      : cloth_(cloth), regions_(cloth, crossings) {
    for (const Crossing& each : crossings) {
      if (each.edge[0] >= cloth.x.size() || each.triangle[0] >= cloth.x.size()) continue;
      Pair pair{&each, {}, 0, 0};
      const Index one = regions_.of(each.edge[0]), other = regions_.of(each.edge[1]);
      if (one != other) {
        pair.cut_off = regions_.smaller(one, other) ? 0u : 1u;
        pair.region = *pair.cut_off == 0 ? one : other;
      }
      pairs_.push_back(pair);
    }
    find_contours();
  }

  void demand(double clearance, double step, std::vector<Demand>& demands) {
    std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
      return a.contour != b.contour ? a.contour < b.contour : a.crossing < b.crossing;
    });
    for (auto begin = pairs_.begin(); begin != pairs_.end();) {
      const auto end =
          std::find_if(begin, pairs_.end(), [&](const Pair& pair) { return pair.contour != begin->contour; });
      demand_of_contour({begin, end}, clearance, step, demands);
      begin = end;
    }
  }

  /// What crosses nothing and lies on the right side stays on its side of the triangles within `reach`, and
  /// at `clearance` if it is that far away.
  void demand_sides(double clearance, double reach, std::vector<Demand>& demands) {
    find_free();
    std::vector<Bounds> boxes;
    std::vector<Index> of_box, near;
    for (Index t = 0; t < cloth_.triangles.size(); ++t) {
      const auto& [a, b, c] = cloth_.triangles[t];
      if (!free_[a] || !free_[b] || !free_[c]) continue;
      const dvec3 &p = cloth_.x[a], &q = cloth_.x[b], &r = cloth_.x[c];
      boxes.push_back({glm::min(p, glm::min(q, r)), glm::max(p, glm::max(q, r))});
      of_box.push_back(t);
    }
    const BoxTree tree(boxes);
    Pieces pieces;
    for (Index i = 0; i < cloth_.x.size(); ++i) {
      pieces.next();
      if (!free_[i]) continue;
      near.clear();
      tree.overlapping({cloth_.x[i] - reach, cloth_.x[i] + reach}, near);
      std::sort(near.begin(), near.end());
      for (const Index box : near) demand_side(i, cloth_.triangles[of_box[box]], clearance, reach, demands);
    }
  }

 private:
  void demand_side(Index vertex, const DressCloth::Triangle& t, double clearance, double reach,
                   std::vector<Demand>& demands) const {
    const auto& [a, b, c] = t;
    if (vertex == a || vertex == b || vertex == c) return;
    if (!cloth_.moves(vertex) && !cloth_.moves(a) && !cloth_.moves(b) && !cloth_.moves(c)) return;
    const dvec3& x = cloth_.x[vertex];
    const PlaceOnTriangle here = nearest_place({cloth_.x[a], cloth_.x[b], cloth_.x[c]}, x);
    const double distance = glm::distance(here.place, x);
    if (distance >= reach || distance < no_distance) return;
    demands.push_back({{vertex, a, b, c},
                       {1.0, -here.shares.x, -here.shares.y, -here.shares.z},
                       (x - here.place) / distance,
                       std::min(distance, clearance)});
  }

  /// Vertices whose triangles cross nothing, in the largest region of their piece.
  void find_free() {
    std::map<Index, Index> largest;
    for (Index i = 0; i < cloth_.x.size(); ++i) {
      const auto [at, fresh] = largest.try_emplace(cloth_.piece[i], regions_.of(i));
      if (regions_.smaller(at->second, regions_.of(i))) at->second = regions_.of(i);
    }
    free_.resize(cloth_.x.size());
    for (Index i = 0; i < cloth_.x.size(); ++i) free_[i] = regions_.of(i) == largest[cloth_.piece[i]];
    for (const Pair& pair : pairs_) {
      for (const Index vertex : pair.crossing->edge) free_[vertex] = false;
      for (const Index vertex : pair.crossing->triangle) free_[vertex] = false;
    }
  }

  /// Two crossings are neighbours on a contour if they are the ends of the line in which the same two
  /// triangles meet.
  void find_contours() {
    std::vector<std::pair<std::array<Index, 2>, Index>> lines;
    for (Index i = 0; i < pairs_.size(); ++i) {
      const Index triangle = cloth_.index_of(pairs_[i].crossing->triangle);
      for (const Index other : cloth_.triangles_at(pairs_[i].crossing->edge))
        lines.push_back({{std::min(triangle, other), std::max(triangle, other)}, i});
    }
    std::sort(lines.begin(), lines.end());
    DisjointSets sets(pairs_.size());
    for (std::size_t i = 1; i < lines.size(); ++i)
      if (lines[i].first == lines[i - 1].first) sets.join(lines[i].second, lines[i - 1].second);
    for (Index i = 0; i < pairs_.size(); ++i) pairs_[i].contour = sets.find(i);
  }

  /// A region with a border goes back whole; where there is one, a region without, which is what the other
  /// surface cuts out where the first goes through it, stays.
  void demand_of_contour(std::span<const Pair> pairs, double clearance, double step,
                         std::vector<Demand>& demands) {
    const bool cuts = std::any_of(pairs.begin(), pairs.end(), [](const Pair& p) { return p.cut_off; });
    const auto bordered = [&](const Pair& p) { return p.cut_off && regions_.has_border(p.region); };
    const bool borders = std::any_of(pairs.begin(), pairs.end(), bordered);
    for (const Pair& pair : pairs) {
      if (!cuts)
        shorten(pair, step, demands);
      else if (borders ? bordered(pair) : pair.cut_off.has_value())
        go_back(pair, clearance, demands);
    }
  }

  dvec3 normal(const DressCloth::Triangle& t) const {
    return normal_of({cloth_.x[t[0]], cloth_.x[t[1]], cloth_.x[t[2]]});
  }
  dvec3 shares(const Crossing& crossing) const {
    const auto& [a, b, c] = crossing.triangle;
    return nearest_place({cloth_.x[a], cloth_.x[b], cloth_.x[c]}, crossing.place).shares;
  }

  /// The end that is cut off, to the other end's side of the triangle.
  void go_back(const Pair& pair, double clearance, std::vector<Demand>& demands) const {
    const Crossing& crossing = *pair.crossing;
    dvec3 to = normal(crossing.triangle);
    const dvec3& kept = cloth_.x[crossing.edge[1 - *pair.cut_off]];
    if (glm::dot(to, kept - cloth_.x[crossing.triangle[0]]) < 0.0) to = -to;
    const dvec3 share = shares(crossing);
    const auto& [a, b, c] = crossing.triangle;
    demands.push_back(
        {{crossing.edge[*pair.cut_off], a, b, c}, {1.0, -share.x, -share.y, -share.z}, to, clearance});
  }

  void shorten(const Pair& pair, double step, std::vector<Demand>& demands) const {
    const Crossing& crossing = *pair.crossing;
    const dvec3 &p = cloth_.x[crossing.edge[0]], &q = cloth_.x[crossing.edge[1]];
    const double length = glm::distance(p, q);
    if (!(length > 0.0)) return;
    const dvec3 along = (q - p) / length, across = normal(crossing.triangle);
    const double slope = glm::dot(along, across);
    constexpr double flattest = 1e-3;  // the edge lies in the triangle's plane: any way along it is as good
    if (std::abs(slope) < flattest) return;
    dvec3 way(0.0);
    for (const Index index : cloth_.triangles_at(crossing.edge)) {
      const DressCloth::Triangle& t = cloth_.triangles[index];
      dvec3 line = glm::cross(normal(t), across);
      if (!(glm::length(line) > flattest)) continue;
      line = glm::normalize(line);
      dvec3 inwards = cloth_.x[opposite(t, crossing.edge[0], crossing.edge[1])] - crossing.place;
      inwards -= along * glm::dot(along, inwards);
      if (glm::dot(line, inwards) < 0.0) line = -line;
      way += line - across * (glm::dot(line, along) / slope);
    }
    constexpr double least_way = 1e-3;  // two triangles in one plane: the contour stays as long
    if (!(glm::length(way) > least_way)) return;
    way = glm::normalize(way);
    const dvec3 share = shares(crossing);
    const double second = std::clamp(glm::distance(p, crossing.place) / length, 0.0, 1.0);
    const auto& [a, b, c] = crossing.triangle;
    demands.push_back({{crossing.edge[0], crossing.edge[1], a, b, c},
                       {1.0 - second, second, -share.x, -share.y, -share.z},
                       way,
                       step});
  }

  const DressCloth& cloth_;
  Regions regions_;
  std::vector<Pair> pairs_;
  std::vector<bool> free_;  // of the vertices: what they are near is on its right side
};

}  // namespace

void demand_untangled(const DressCloth& cloth, const std::vector<Crossing>& crossings, double clearance,
                      double step, std::vector<Demand>& demands) {
  between_pieces();
  Untangling untangling(cloth, crossings);
  untangling.demand(clearance, step, demands);
  untangling.demand_sides(clearance, clearance + 2.0 * step, demands);
}

}  // namespace clothlab::model
