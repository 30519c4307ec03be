// Which vertices of a file are one: those at the same place, as far as the file's numbers tell.
//
// Programs split meshes along seams of texture and shading, and what they compute or round of a vertex then
// comes out a little different for each of its copies. So vertices are one that are nearer than
//   four spacings of 32-bit floats at the mesh's largest coordinate, in which most programs hold places, or
//   two units of the last digit that the file has, if it has about as many digits as such floats (%.6f, %g),
//   or a micrometre, if what can be mended is: no cloth is that thin,
// and never farther apart than a thousandth of the shortest side at either: no two corners of a face are one,
// and layers of cloth stay two. Where faces would come to lie on each other, these are layers too, however
// near.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "server/mesh/place_grid.h"
#include "server/mesh/raw.h"

namespace clothlab::mesh {

namespace {

using glm::dvec3;
using Index = std::uint32_t;

constexpr double float_spacings = 0x1p-22;               // four of 2^-24, over the largest coordinate
constexpr double most_units = 2.5, least_digits = 1e-5;  // 1.25 units or more are left below (levels)
constexpr double micrometre = 1e-6;
constexpr double most_of_side = 1e-3;
constexpr double least_share =
    0x1p-50;  // of the largest coordinate: what is nearer is the same in doubles, too
constexpr std::size_t most_join_looks = 200'000'000;

/// For each vertex the first one at exactly the same place.
std::vector<Index> first_at_place(const std::vector<dvec3>& vertices) {
  std::vector<Index> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](Index i) { return std::tie(vertices[i].x, vertices[i].y, vertices[i].z); };
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

class Joining {
 public:
  explicit Joining(const Raw& raw) : raw_(raw), exact_(first_at_place(raw.vertices)), first_(exact_) {}

  Joined run() {
    measure_sides();
    if (join_near()) leave_layers();
    Joined result{std::move(first_), std::max(rounding(), raw_.mend ? micrometre : 0.0), {}};
    for (Index i = 0; i < exact_.size() && result.reach > rounding(); ++i) {
      const Index same = result.first[i];
      if (exact_[i] == i && glm::distance(raw_.vertices[i], raw_.vertices[same]) > rounding())
        result.welded.push_back(i);
    }
    return result;
  }

 private:
  template <class Visit>
  void each_side(const Face& face, Visit&& visit) const {
    for (Index i = 0; i < face.count; ++i)
      visit(raw_.corners[face.first + i].vertex, raw_.corners[face.first + (i + 1) % face.count].vertex);
  }

  void measure_sides() {
    shortest_.assign(raw_.vertices.size(), std::numeric_limits<double>::infinity());
    for (const Face& face : raw_.faces)
      each_side(face, [&](Index a, Index b) {
        const double length = glm::distance(raw_.vertices[a], raw_.vertices[b]);
        if (!(length > 0.0)) return;
        for (const Index end : {exact_[a], exact_[b]}) shortest_[end] = std::min(shortest_[end], length);
        for (int axis = 0; axis < 3; ++axis) largest_ = std::max(largest_, std::abs(raw_.vertices[a][axis]));
      });
  }

  /// What numbers of the file may differ by that were the same before they were rounded [m].
  double rounding() const {
    const double units = raw_.unit <= least_digits * largest_ ? most_units * raw_.unit : 0.0;
    return std::max(float_spacings * largest_, units);
  }

  /// Vertices by how near another must be to be the same: a power of 2, or a micrometre [m], the largest
  /// first. Those of one level that are not joined are farther apart than that, so that a cell never holds
  /// many.
  std::map<double, std::vector<Index>, std::greater<>> levels() const {
    const double most = std::max(rounding(), raw_.mend ? micrometre : 0.0);
    std::map<double, std::vector<Index>, std::greater<>> found;
    for (Index i = 0; i < exact_.size(); ++i) {
      if (exact_[i] != i || !std::isfinite(shortest_[i])) continue;
      const double near = std::min(most, most_of_side * shortest_[i]);
      if (!(near > least_share * largest_)) continue;
      const double power = std::ldexp(1.0, std::ilogb(near));
      found[raw_.mend && near >= micrometre ? std::max(power, micrometre) : power].push_back(i);
    }
    return found;
  }

  /// Returns true if any vertices have become one.
  bool join_near() {
    std::size_t budget = most_join_looks;
    bool any = false;
    std::vector<Index> apart;  // of all levels so far
    for (const auto& [reach, members] : levels()) {
      PlaceGrid grid(8.0 * reach);
      for (const Index i : apart) grid.add(i, raw_.vertices[i]);
      for (const Index i : members) {
        const dvec3& place = raw_.vertices[i];
        Index same = i;
        const bool whole = grid.near(place - reach, place + reach, budget, [&](Index other) {
          if (same == i && glm::distance(place, raw_.vertices[other]) <= reach) same = other;
        });
        if (!whole) return any;
        any = any || same != i;
        if (same == i) {
          grid.add(i, place);
          apart.push_back(i);
        } else {
          first_[i] = same;
        }
      }
    }
    if (any) name_by_first();
    return any;
  }

  /// Of the vertices that are one, the first in the file stands for all.
  void name_by_first() {
    std::vector<Index> least(first_.size());
    std::iota(least.begin(), least.end(), 0u);
    const auto stands = [&](Index i) { return first_[exact_[i]]; };
    for (Index i = 0; i < first_.size(); ++i) least[stands(i)] = std::min(least[stands(i)], i);
    std::vector<Index> named(first_.size());
    for (Index i = 0; i < first_.size(); ++i) named[i] = least[stands(i)];
    first_ = std::move(named);
  }

  std::vector<Index> corners_of(Index face, const std::vector<Index>& first) const {
    std::vector<Index> corners;
    for (Index i = 0; i < raw_.faces[face].count; ++i)
      corners.push_back(first[raw_.corners[raw_.faces[face].first + i].vertex]);
    std::sort(corners.begin(), corners.end());
    return corners;
  }

  /// Takes apart again what would leave a face with two corners at one vertex, or two faces with the same
  /// corners, unless the file has them so.
  void leave_layers() {
    std::vector<char> apart(first_.size(), 0);
    std::vector<std::pair<std::vector<Index>, Index>> faces;
    for (Index f = 0; f < raw_.faces.size(); ++f) {
      std::vector<Index> corners = corners_of(f, first_);
      const auto twice = std::adjacent_find(corners.begin(), corners.end());
      if (twice != corners.end()) {
        const std::vector<Index> exact = corners_of(f, exact_);
        if (std::adjacent_find(exact.begin(), exact.end()) == exact.end())
          for (std::size_t k = 1; k < corners.size(); ++k)
            if (corners[k] == corners[k - 1]) apart[corners[k]] = 1;
      }
      faces.emplace_back(std::move(corners), f);
    }
    std::sort(faces.begin(), faces.end());
    for (std::size_t k = 1; k < faces.size(); ++k)
      if (faces[k].first == faces[k - 1].first &&
          corners_of(faces[k].second, exact_) != corners_of(faces[k - 1].second, exact_))
        for (const Index corner : faces[k].first) apart[corner] = 1;
    for (Index i = 0; i < first_.size(); ++i)
      if (apart[first_[i]]) first_[i] = exact_[i];
  }

  const Raw& raw_;
  const std::vector<Index> exact_;
  std::vector<Index> first_;
  std::vector<double> shortest_;  // side at each vertex [m]; at the first of those at one place
  double largest_ = 0.0;          // coordinate of any side [m]
};

}  // namespace

Joined joined(const Raw& raw, bool rounded) {
  if (rounded) return Joining(raw).run();
  return {first_at_place(raw.vertices), 0.0, {}};
}

}  // namespace clothlab::mesh
