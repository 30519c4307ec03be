#include "server/model/plate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "server/base/pieces.h"
#include "server/model/slope_form.h"
#include "server/model/unfold.h"

namespace clothlab::model {

namespace {

using glm::dvec3;
using Index = std::uint32_t;

/// Everything that the pairs are made from.
struct Plate {
  const Triangles& triangles;
  const std::vector<FlatTriangle>& flat;
  const std::vector<char>& held;
  const PlateStiffness& stiffness;
  Neighbours beside;

  bool clamp(Index triangle) const {
    const auto& corners = triangles[triangle];
    return std::all_of(corners.begin(), corners.end(), [&](Index vertex) { return held[vertex]; });
  }
};

/// What bends at one edge of a triangle: the slope across the edge's middle less the triangle's own, as a
/// form; and the curvature (warp, weft, twist) of the triangle for a difference of 1.
struct Hinge {
  Form form{};
  dvec3 curvature{0.0};
  bool free = false;
};

Hinge hinge(const Plate& plate, const Placed& own, Index triangle, std::size_t edge, Nodes& nodes) {
  const dvec2 first = own.corners[(edge + 1) % 3], second = own.corners[(edge + 2) % 3];
  const dvec2 middle = 0.5 * (first + second);
  const double length = glm::distance(first, second);
  const dvec2 normal = dvec2(second.y - first.y, first.x - second.x) / length;
  const double area = 0.5 * cross(own.corners[1] - own.corners[0], own.corners[2] - own.corners[0]);
  Hinge result;
  result.curvature = length / area * dvec3(normal.x * normal.x, normal.y * normal.y, normal.x * normal.y);
  const std::optional<Neighbour>& there = plate.beside[triangle][edge];
  result.free = !there;
  if (!there) return result;

  const auto spread = [&](const Placed& from, std::size_t from_corner, const Neighbour& to) {
    return unfolded(from, from_corner, plate.triangles[to.triangle], plate.flat[to.triangle],
                    static_cast<std::size_t>(to.corner));
  };
  std::vector<std::size_t> patch{0, 1, 2};
  const auto take = [&](const Placed& placed, int corner) {
    const auto k = static_cast<std::size_t>(corner);
    const std::size_t node = nodes.add(placed.vertices[k], placed.corners[k]);
    if (std::find(patch.begin(), patch.end(), node) == patch.end()) patch.push_back(node);
  };
  const Placed other = spread(own, edge, *there);
  take(other, there->corner);
  const std::array<double, 3> own_slopes = slopes(own.corners, normal);
  // A neighbour of the other orientation is laid out clockwise: slopes() takes either.
  const std::array<double, 3> other_slopes = slopes(other.corners, normal);
  const auto add = [&](const Placed& placed, const std::array<double, 3>& of, double share) {
    for (std::size_t k = 0; k < 3; ++k)
      result.form[nodes.add(placed.vertices[k], placed.corners[k])] += share * of[k];
  };
  if (plate.clamp(there->triangle)) {
    add(other, other_slopes, 1.0);
  } else {
    add(own, own_slopes, 0.5);
    add(other, other_slopes, 0.5);
    for (std::size_t k = 0; k < 3; ++k) {
      if (const auto& next = plate.beside[triangle][k]; k != edge && next)
        take(spread(own, k, *next), next->corner);
      if (const auto& next = plate.beside[there->triangle][k];
          k != static_cast<std::size_t>(there->corner) && next)
        take(spread(other, k, *next), next->corner);
    }
    make_exact(result.form, nodes, patch, middle, normal, length);
  }
  add(own, own_slopes, -1.0);
  return result;
}

/// The triangle's energy, 1/2 sum of moment[i][j] h_i h_j over the differences of slope h at its edges. A
/// free edge has none: its slope is the one of least energy.
std::array<std::array<double, 3>, 3> moments(const std::array<Hinge, 3>& hinges, double area,
                                             const PlateStiffness& stiffness) {
  const dvec3 weight = area * dvec3(stiffness.warp, stiffness.weft, 4.0 * stiffness.twist);
  std::array<std::array<double, 3>, 3> moment{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      moment[i][j] = glm::dot(weight * hinges[i].curvature, hinges[j].curvature);
  for (std::size_t free = 0; free < 3; ++free) {
    if (!hinges[free].free) continue;
    const double own = moment[free][free];
    const std::array<double, 3> column{moment[0][free], moment[1][free], moment[2][free]};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) moment[i][j] -= own > 0.0 ? column[i] * column[j] / own : 0.0;
  }
  return moment;
}
/// A triangle's energy: the differences of slope at its edges as forms, and their moments.
struct BentTriangle {
  Nodes nodes;
  std::array<Hinge, 3> hinges;
  std::array<std::array<double, 3>, 3> moment{};
};

BentTriangle bent_triangle(const Plate& plate, Index triangle) {
  const Placed own{plate.triangles[triangle], plate.flat[triangle]};
  BentTriangle result;
  for (std::size_t k = 0; k < 3; ++k) result.nodes.add(own.vertices[k], own.corners[k]);
  for (std::size_t edge = 0; edge < 3; ++edge)
    result.hinges[edge] = hinge(plate, own, triangle, edge, result.nodes);
  const double area = 0.5 * cross(own.corners[1] - own.corners[0], own.corners[2] - own.corners[0]);
  result.moment = moments(result.hinges, area, plate.stiffness);
  return result;
}
void add_triangle(const Plate& plate, Index triangle, PairSum& pairs) {
  if (plate.clamp(triangle)) return;
  const auto [nodes, hinges, moment] = bent_triangle(plate, triangle);
  // The energy is 1/2 sum of q_vw x_v.x_w over the nodes, whose rows add up to 0: pairs with k = -q_vw.
  for (std::size_t v = 0; v < nodes.count; ++v)
    for (std::size_t w = 0; w < v; ++w) {
      double q = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q += moment[i][j] * hinges[i].form[v] * hinges[j].form[w];
      pairs.add(nodes.vertex[v], nodes.vertex[w], -q);
    }
}
/// Lower triangle L with L L^T = `matrix` (Cholesky), which is positive semi-definite.
std::array<std::array<double, 3>, 3> root(const std::array<std::array<double, 3>, 3>& matrix) {
  const double rounding = 1e-12 * (matrix[0][0] + matrix[1][1] + matrix[2][2]);
  std::array<std::array<double, 3>, 3> lower{};
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t i = j; i < 3; ++i) {
      double left = matrix[i][j];
      for (std::size_t k = 0; k < j; ++k) left -= lower[i][k] * lower[j][k];
      if (i == j)
        lower[j][j] = left > rounding ? std::sqrt(left) : 0.0;
      else
        lower[i][j] = lower[j][j] > 0.0 ? left / lower[j][j] : 0.0;
    }
  return lower;
}
}  // namespace

std::vector<CurvatureRows> curvature_rows(const Triangles& triangles, const std::vector<FlatTriangle>& flat,
                                          const std::vector<char>& held, const PlateStiffness& stiffness) {
  const Plate plate{triangles, flat, held, stiffness, neighbours(triangles)};
  std::vector<CurvatureRows> result;
  if (!(stiffness.warp > 0.0 || stiffness.weft > 0.0 || stiffness.twist > 0.0)) return result;
  Pieces pieces;
  for (Index triangle = 0; triangle < triangles.size(); ++triangle) {
    pieces.next();
    if (plate.clamp(triangle)) continue;
    const auto [nodes, hinges, moment] = bent_triangle(plate, triangle);
    const auto lower = root(moment);
    CurvatureRows rows;
    rows.vertices.fill(nodes.vertex[0]);
    for (std::size_t n = 0; n < nodes.count; ++n) {
      rows.vertices[n] = nodes.vertex[n];
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t i = a; i < 3; ++i) rows.row[a][n] += lower[i][a] * hinges[i].form[n];
    }
    result.push_back(rows);
  }
  return result;
}
std::vector<BendingPair> bending_pairs(const Triangles& triangles, const std::vector<FlatTriangle>& flat,
                                       const std::vector<char>& held, const PlateStiffness& stiffness) {
  const Plate plate{triangles, flat, held, stiffness, neighbours(triangles)};
  PairSum pairs;
  Pieces pieces;
  for (Index triangle = 0; triangle < triangles.size(); ++triangle) {
    pieces.next();
    add_triangle(plate, triangle, pairs);
  }
  return std::move(pairs).take();
}

std::vector<BendingPair> bending_pairs(const std::vector<CurvatureRows>& triangles) {
  PairSum pairs;
  for (const auto& [vertices, row] : triangles)
    for (std::size_t v = 0; v < vertices.size(); ++v)
      for (std::size_t w = 0; w < v; ++w)
        pairs.add(vertices[v], vertices[w],
                  -(row[0][v] * row[0][w] + row[1][v] * row[1][w] + row[2][v] * row[2][w]));
  return std::move(pairs).take();
}

}  // namespace clothlab::model
