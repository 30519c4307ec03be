// Springs along edges alone, as in Van Gelder 1998 ("Approximate simulation of elastic membranes by
// triangulated spring meshes"), make a mesh of right triangles three times as stiff along its diagonals as
// across them. So the springs across edges take part, as the second diagonals of a grid do, and the stiffness
// is found from what a sheet needs, under every uniform strain: each vertex feels the force that linear
// finite elements give it, so that the mesh is in balance and pulls at its border as the sheet does; and the
// springs at each vertex carry the tensions of its share of the sheet, as forces cancel in a regular mesh
// whatever its springs. Both are solved by least squares within bounds, since a spring must not push apart
// what it should hold together.
#include "server/model/sheet_springs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::model {

namespace {

/// Force and tension at a vertex, as they depend on the strain e, from springs of the directions n and w =
/// stiffness * length^2: the force is the sum of w/length (n.e.n) n, and the tensions times the area are the
/// sum of w/2 (n.e.n) n n. Both are symmetric in all indices: ten and fifteen numbers, weighted so that the
/// product of two is their sum over all indices.
struct Felt {
  std::array<double, 10> force{};
  std::array<double, 15> tension{};
};

Felt along(const dvec3& n) {
  const double xx = n.x * n.x, yy = n.y * n.y, zz = n.z * n.z, xy = n.x * n.y, yz = n.y * n.z, zx = n.z * n.x;
  const double root3 = std::sqrt(3.0), root6 = std::sqrt(6.0), root12 = std::sqrt(12.0);
  return {{xx * n.x, yy * n.y, zz * n.z, root3 * xx * n.y, root3 * xx * n.z, root3 * yy * n.x,
           root3 * yy * n.z, root3 * zz * n.x, root3 * zz * n.y, root6 * xy * n.z},
          {xx * xx, yy * yy, zz * zz, 2 * xx * xy, 2 * xx * zx, 2 * yy * xy, 2 * yy * yz, 2 * zz * zx,
           2 * zz * yz, root6 * xx * yy, root6 * yy * zz, root6 * zz * xx, root12 * xx * yz, root12 * yy * zx,
           root12 * zz * xy}};
}

template <std::size_t n>
void add(std::array<double, n>& to, double share, const std::array<double, n>& from) {
  for (std::size_t i = 0; i < n; ++i) to[i] += share * from[i];
}

template <std::size_t n>
double product(const std::array<double, n>& a, const std::array<double, n>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// A sheet of modulus 1 in the plane of the unit vectors u and v: its force on a line across v, a metre of
/// it, and its tensions. Springs in eight directions give them exactly.
Felt all_round(const dvec3& u, const dvec3& v) {
  Felt sum;
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::acos(-1.0) / 8.0;
    const Felt one = along(std::cos(angle) * u + std::sin(angle) * v);
    add(sum.force, std::sin(angle), one.force);
    add(sum.tension, 1.0, one.tension);
  }
  return sum;
}

/// The part of a triangle that is nearest to each corner; of an obtuse one half, and two quarters (Meyer,
/// Desbrun, Schroeder & Barr 2003, section 3.3). Vertices of a regular mesh get the same, however many of its
/// triangles' corners meet at each.
std::array<double, 3> areas_at(const std::array<dvec3, 3>& corners) {
  std::array<double, 3> cosine, squared, areas;  // |a| |b| cos, opposite side, result
  const double twice = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const dvec3 a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
    cosine[i] = glm::dot(a, b);
    squared[i] = glm::dot(a - b, a - b);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    if (cosine[i] <= 0.0)
      areas[i] = twice / 4.0;
    else if (cosine[j] <= 0.0 || cosine[k] <= 0.0)
      areas[i] = twice / 8.0;
    else
      areas[i] = (cosine[j] * squared[j] + cosine[k] * squared[k]) / (8.0 * twice);
  }
  return areas;
}

class Fit {
 public:
  Fit(const std::vector<dvec3>& position, const std::vector<std::array<std::uint32_t, 3>>& triangles,
      const std::vector<SheetPair>& pairs, const SpringSheet& sheet)
      : pairs_(pairs), residual_(position.size()), importance_(position.size(), 0.0) {
    for (const auto& corners : triangles) add_triangle(position, corners);
    for (double& area : importance_) area = area > 0.0 ? 1.0 / area : 0.0;
    const double share = sheet.across / sheet.modulus;
    for (const SheetPair& pair : pairs) add_pair(position, pair, share);
  }

  /// Stiffnesses for a modulus of 1.
  std::vector<double> run() {
    constexpr int rounds = 20;  // more change no load of tests/bench/triangulations.cpp by 1 %
    for (int round = 0; round < rounds; ++round)
      for (std::size_t i = 0; i < springs_.size(); ++i) improve(i);
    const double short_by = shortfall();
    std::vector<double> stiffness;
    stiffness.reserve(springs_.size());
    for (const Spring& spring : springs_)
      stiffness.push_back(spring.length > 0.0 ? std::min(short_by * spring.w, spring.most_w()) /
                                                    (spring.length * spring.length)
                                              : of_a_grid);
    return stiffness;
  }

 private:
  static constexpr double most_stiffness = 8.0, least_stiffness = 0.05, of_a_grid = 2.0;
  /// An edge keeps this part of its share at least, or a mesh could come apart into hinges.
  static constexpr double least_share = 0.1;
  /// How much less a departure from equal shares counts than a force out of balance.
  static constexpr double preference = 1e-3;

  struct Spring {
    Felt direction;
    double length, w, wanted, scale, least, most;
    double most_w() const { return most_stiffness * length * length; }
  };

  /// Tension that all springs should carry in a stretch in all directions, over what they do carry: 1 in
  /// regular meshes, up to 1.1 in irregular ones, where bounds keep springs from what they should do.
  double shortfall() const {
    double sheet = 0.0, carried = 0.0;
    for (const Spring& spring : springs_) carried += spring.w;
    for (const SheetPair& pair : pairs_)
      if (!pair.across) sheet += 8.0 * pair.area;
    constexpr double most = 1.25;
    return carried > 0.0 ? std::clamp(sheet / carried, 1.0, most) : 1.0;
  }

  void add_triangle(const std::vector<dvec3>& position, const std::array<std::uint32_t, 3>& corners) {
    const std::array<double, 3> shares =
        areas_at({position[corners[0]], position[corners[1]], position[corners[2]]});
    for (std::size_t i = 0; i < 3; ++i) {
      const dvec3 &at = position[corners[i]], &from = position[corners[(i + 1) % 3]];
      const dvec3 along = position[corners[(i + 2) % 3]] - from;
      const double length = glm::length(along);
      if (!(length > 0.0)) continue;
      const dvec3 u = along / length;
      dvec3 up = at - from;
      up -= u * glm::dot(u, up);
      const double height = glm::length(up);
      if (!(height > 1e-7 * length)) continue;
      const Felt sheet = all_round(u, up / height);
      add(residual_[corners[i]].force, 0.5 * length, sheet.force);
      add(residual_[corners[i]].tension, -shares[i], sheet.tension);
      importance_[corners[i]] += shares[i];
    }
  }

  void add_pair(const std::vector<dvec3>& position, const SheetPair& pair, double share) {
    const dvec3 between = position[pair.b] - position[pair.a];
    const double length = glm::length(between), whole = 8.0 * pair.area;
    Spring spring{};
    spring.length = length;
    if (length > 0.0) {
      spring.direction = along(between / length);
      spring.scale = std::max(whole, 1e-6 * length * length);
      spring.most = spring.most_w();
      spring.least = pair.across ? share * whole
                                 : std::max(least_share * (1.0 - share) * whole,
                                            least_stiffness * length * length);  // of triangles without area
      spring.least = std::min(spring.least, spring.most);
      if (pair.across && !pair.diagonal) spring.most = spring.least;
      spring.wanted = std::clamp((pair.across ? share : 1.0 - share) * whole, spring.least, spring.most);
      move(pair, spring, spring.wanted);
    }
    springs_.push_back(spring);
  }

  void move(const SheetPair& pair, Spring& spring, double to) {
    const double change = to - spring.w;
    Felt &a = residual_[pair.a], &b = residual_[pair.b];
    add(a.force, change / spring.length, spring.direction.force);
    add(b.force, -change / spring.length, spring.direction.force);
    add(a.tension, 0.5 * change, spring.direction.tension);
    add(b.tension, 0.5 * change, spring.direction.tension);
    spring.w = to;
  }

  /// Moves one spring to its best value, and half as far beyond, which converges faster.
  void improve(std::size_t index) {
    Spring& spring = springs_[index];
    const SheetPair& pair = pairs_[index];
    if (!(spring.most > spring.least)) return;
    const double inverse = 1.0 / spring.length, weak = preference / (spring.scale * spring.scale);
    const double a = importance_[pair.a], b = importance_[pair.b];
    const Felt &at_a = residual_[pair.a], &at_b = residual_[pair.b], &own = spring.direction;
    const double slope =
        inverse * (a * product(at_a.force, own.force) - b * product(at_b.force, own.force)) +
        0.5 * (a * a * product(at_a.tension, own.tension) + b * b * product(at_b.tension, own.tension)) +
        weak * (spring.w - spring.wanted);
    const double curvature = inverse * inverse * (a + b) + 0.25 * (a * a + b * b) + weak;
    move(pair, spring, std::clamp(spring.w - 1.5 * slope / curvature, spring.least, spring.most));
  }

  const std::vector<SheetPair>& pairs_;
  std::vector<Spring> springs_;
  std::vector<Felt> residual_;      ///< [vertex_count] what springs do less what the sheet does
  std::vector<double> importance_;  ///< [vertex_count] 1 / area [1/m^2]
};

}  // namespace

std::vector<double> sheet_stiffness(const std::vector<dvec3>& position,
                                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                    const std::vector<SheetPair>& pairs, const SpringSheet& sheet) {
  std::vector<double> stiffness = Fit(position, triangles, pairs, sheet).run();
  for (double& one : stiffness) one *= sheet.modulus;
  return stiffness;
}

}  // namespace clothlab::model
