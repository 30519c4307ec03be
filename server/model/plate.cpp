#include "server/model/plate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

namespace clothlab::model {

namespace {

using glm::dmat3;
using glm::dvec3;
using Index = std::uint32_t;
using Triangles = std::vector<std::array<Index, 3>>;

/// The triangle on the other side of an edge, and the number of its corner opposite the edge.
struct Neighbour {
  Index triangle = 0;
  int corner = 0;
};
/// For each edge of a triangle, by the number of the corner opposite it.
using Neighbours = std::vector<std::array<std::optional<Neighbour>, 3>>;

Neighbours neighbours(const Triangles& triangles) {
  struct Side {
    Index low, high, triangle;
    int corner;
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (Index t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles[t][(i + 1) % 3], triangles[t][(i + 2) % 3]);
      sides.push_back({low, high, t, i});
    }
  const auto edge = [](const Side& side) { return std::pair(side.low, side.high); };
  std::stable_sort(sides.begin(), sides.end(),
                   [&](const Side& a, const Side& b) { return edge(a) < edge(b); });
  Neighbours result(triangles.size());
  for (std::size_t first = 0, end; first < sides.size(); first = end) {
    for (end = first + 1; end < sides.size() && edge(sides[end]) == edge(sides[first]);) ++end;
    if (end - first != 2) continue;
    const Side &a = sides[first], &b = sides[first + 1];
    result[a.triangle][static_cast<std::size_t>(a.corner)] = Neighbour{b.triangle, b.corner};
    result[b.triangle][static_cast<std::size_t>(b.corner)] = Neighbour{a.triangle, a.corner};
  }
  return result;
}

double cross(const dvec2& a, const dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// A triangle laid out beside others in one plane.
struct Placed {
  std::array<Index, 3> vertices{};
  FlatTriangle corners{};
};

/// Unfolds `triangle`, whose own rest shape is `flat`, across the edge that it shares with `from`: its corner
/// `corner` comes to lie on the side of the edge where `from` is not.
Placed unfolded(const Placed& from, std::size_t from_corner, const std::array<Index, 3>& triangle,
                const FlatTriangle& flat, std::size_t corner) {
  const std::size_t first = (corner + 1) % 3, second = (corner + 2) % 3;
  Placed placed{triangle, {}};
  for (const std::size_t end : {first, second})
    for (std::size_t k = 0; k < 3; ++k)
      if (from.vertices[k] == triangle[end]) placed.corners[end] = from.corners[k];
  const dvec2 own_edge = flat[second] - flat[first], own_apex = flat[corner] - flat[first];
  const double length = glm::length(own_edge);
  const double along = glm::dot(own_apex, own_edge) / length,
               height = std::abs(cross(own_edge, own_apex)) / length;
  const dvec2 edge = glm::normalize(placed.corners[second] - placed.corners[first]), left(-edge.y, edge.x);
  const bool from_is_left = glm::dot(from.corners[from_corner] - placed.corners[first], left) > 0.0;
  placed.corners[corner] = placed.corners[first] + along * edge + (from_is_left ? -height : height) * left;
  return placed;
}

/// The vertices around a triangle, laid out in its plane, and a number for each: a linear form of a field of
/// values at the vertices.
constexpr std::size_t most_nodes = 12;
using Form = std::array<double, most_nodes>;
struct Nodes {
  std::array<Index, most_nodes> vertex{};
  std::array<dvec2, most_nodes> place{};
  std::size_t count = 0;

  /// The number of the vertex's node, which is made if needed. A vertex keeps its first place.
  std::size_t add(Index which, const dvec2& where) {
    const auto end = vertex.begin() + static_cast<std::ptrdiff_t>(count);
    const auto found = std::find(vertex.begin(), end, which);
    if (found != end) return static_cast<std::size_t>(found - vertex.begin());
    vertex[count] = which;
    place[count] = where;
    return count++;
  }
};

/// Derivatives along `direction` of the three functions that are linear on the triangle and 1 at one corner.
std::array<double, 3> slopes(const FlatTriangle& corners, const dvec2& direction) {
  const double twice_area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec2 side = corners[(i + 2) % 3] - corners[(i + 1) % 3];
    result[i] = (-side.y * direction.x + side.x * direction.y) / twice_area;
  }
  return result;
}

/// Changes `slope` as little as possible (in the sum of squares) so that it is exact for every quadratic
/// function: the derivative along `normal` at `middle`. Only the nodes in `patch` take part; lengths are
/// measured in `unit`. Conditions that the patch can hardly meet are left out, the linear ones never.
void make_exact(Form& slope, const Nodes& nodes, const std::vector<std::size_t>& patch, const dvec2& middle,
                const dvec2& normal, double unit) {
  constexpr std::size_t conditions = 6, linear = 3;
  constexpr double hardly = 0.1;  // share of a condition that the others leave to it
  std::array<std::array<double, 8>, conditions> condition{};
  std::array<double, conditions> lacking{0.0, normal.x / unit, normal.y / unit, 0.0, 0.0, 0.0};
  for (std::size_t n = 0; n < patch.size(); ++n) {
    const dvec2 at = (nodes.place[patch[n]] - middle) / unit;
    const std::array<double, conditions> values{1.0, at.x, at.y, at.x * at.x, at.y * at.y, at.x * at.y};
    for (std::size_t c = 0; c < conditions; ++c) {
      condition[c][n] = values[c];
      lacking[c] -= values[c] * slope[patch[n]];
    }
  }
  // Gram-Schmidt: the change is a sum of orthonormal directions, each fixed by one more condition.
  const auto dot = [&](const auto& a, const auto& b) {
    double sum = 0.0;
    for (std::size_t n = 0; n < patch.size(); ++n) sum += a[n] * b[n];
    return sum;
  };
  std::array<double, conditions> whole{};
  for (std::size_t c = 0; c < conditions; ++c) whole[c] = std::sqrt(dot(condition[c], condition[c]));
  std::array<double, 8> change{};
  std::vector<std::size_t> open{0, 1, 2, 3, 4, 5};
  for (std::size_t taken = 0; !open.empty(); ++taken) {
    // `condition[c]` has become what is left of it beside the directions taken so far.
    const auto left = [&](std::size_t c) { return std::sqrt(dot(condition[c], condition[c])) / whole[c]; };
    auto next = open.begin();
    if (taken >= linear)
      next = std::max_element(open.begin(), open.end(), [&](auto a, auto b) { return left(a) < left(b); });
    const std::size_t c = *next;
    const double size = std::sqrt(dot(condition[c], condition[c]));
    if (!(size > hardly * whole[c])) break;
    open.erase(next);
    std::array<double, 8> direction = condition[c];
    for (double& component : direction) component /= size;
    const double share = lacking[c] / size;
    for (std::size_t n = 0; n < patch.size(); ++n) change[n] += share * direction[n];
    for (const std::size_t other : open) {
      const double common = dot(condition[other], direction);
      lacking[other] -= common * share;
      for (std::size_t n = 0; n < patch.size(); ++n) condition[other][n] -= common * direction[n];
    }
  }
  for (std::size_t n = 0; n < patch.size(); ++n) slope[patch[n]] += change[n];
}

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

/// Adds up the pairs that are equal, and sorts them.
void merge(std::vector<BendingPair>& pairs) {
  const auto before = [](const BendingPair& p, const BendingPair& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  };
  std::stable_sort(pairs.begin(), pairs.end(), before);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (kept > 0 && pairs[kept - 1].a == pairs[i].a && pairs[kept - 1].b == pairs[i].b)
      pairs[kept - 1].stiffness += pairs[i].stiffness;
    else
      pairs[kept++] = pairs[i];
  }
  pairs.resize(kept);
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

void add_triangle(const Plate& plate, Index triangle, std::vector<BendingPair>& pairs) {
  if (plate.clamp(triangle)) return;
  const auto [nodes, hinges, moment] = bent_triangle(plate, triangle);
  // The energy is 1/2 sum of q_vw x_v.x_w over the nodes, whose rows add up to 0: pairs with k = -q_vw.
  for (std::size_t v = 0; v < nodes.count; ++v)
    for (std::size_t w = 0; w < v; ++w) {
      double q = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) q += moment[i][j] * hinges[i].form[v] * hinges[j].form[w];
      const auto [a, b] = std::minmax(nodes.vertex[v], nodes.vertex[w]);
      if (q != 0.0) pairs.push_back({a, b, -q});
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
  for (Index triangle = 0; triangle < triangles.size(); ++triangle) {
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

/// The sum of the pairs of all triangles, each once: add(triangle, pairs) appends those of one triangle.
template <class Add>
std::vector<BendingPair> summed_pairs(std::size_t triangles, const std::vector<char>& held, Add add) {
  constexpr std::size_t most_unmerged = 1u << 22;  // 64 MiB
  constexpr double rounding = 1e-10;               // share of the largest stiffness
  std::vector<BendingPair> pairs;
  std::size_t merged = 0;
  for (std::size_t triangle = 0; triangle < triangles; ++triangle) {
    add(triangle, pairs);
    if (pairs.size() < 2 * merged + most_unmerged) continue;
    merge(pairs);
    merged = pairs.size();
  }
  merge(pairs);
  double largest = 0.0;
  for (const BendingPair& pair : pairs) largest = std::max(largest, std::abs(pair.stiffness));
  std::erase_if(pairs, [&](const BendingPair& pair) {
    return std::abs(pair.stiffness) <= rounding * largest || (held[pair.a] && held[pair.b]);
  });
  return pairs;
}

std::vector<BendingPair> bending_pairs(const Triangles& triangles, const std::vector<FlatTriangle>& flat,
                                       const std::vector<char>& held, const PlateStiffness& stiffness) {
  const Plate plate{triangles, flat, held, stiffness, neighbours(triangles)};
  return summed_pairs(triangles.size(), held, [&](std::size_t triangle, std::vector<BendingPair>& pairs) {
    add_triangle(plate, static_cast<Index>(triangle), pairs);
  });
}

std::vector<BendingPair> bending_pairs(const std::vector<CurvatureRows>& triangles,
                                       const std::vector<char>& held) {
  return summed_pairs(triangles.size(), held, [&](std::size_t triangle, std::vector<BendingPair>& pairs) {
    const auto& [vertices, row] = triangles[triangle];
    for (std::size_t v = 0; v < vertices.size(); ++v)
      for (std::size_t w = 0; w < v; ++w) {
        const double q = row[0][v] * row[0][w] + row[1][v] * row[1][w] + row[2][v] * row[2][w];
        const auto [a, b] = std::minmax(vertices[v], vertices[w]);
        if (q != 0.0) pairs.push_back({a, b, -q});
      }
  });
}

}  // namespace clothlab::model
