// Springs along edges alone, as in Van Gelder 1998 ("Approximate simulation of elastic membranes by
// triangulated spring meshes"), make a mesh of right triangles three times as stiff along its diagonals as
// across them. So the springs across edges take part, as the second diagonals of a grid do, and the stiffness
// is found from what a sheet needs: under every uniform strain each vertex shall feel the force that linear
// finite elements give it. Then a mesh at uniform strain is in balance, and pulls at its border as the sheet
// does. That is four equations for a vertex of a flat mesh, which has six springs. They are solved by least
// squares within bounds, since a spring must not push apart what it should hold together.
#include "server/model/sheet_springs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace clothlab::model {

namespace {

/// The force on a vertex as it depends on the strain e: the sum over its springs of w/L (n.e.n) n, with n the
/// direction and w = stiffness * L^2. It is symmetric in its three indices: ten numbers, weighted so that
/// the product of two is their sum over all indices.
using Cubic = std::array<double, 10>;

constexpr double root3 = 1.7320508075688772, root6 = 2.449489742783178;

Cubic cube(const dvec3& n) {
  return {n.x * n.x * n.x,         n.y * n.y * n.y,         n.z * n.z * n.z,         root3 * n.x * n.x * n.y,
          root3 * n.x * n.x * n.z, root3 * n.y * n.y * n.x, root3 * n.y * n.y * n.z, root3 * n.z * n.z * n.x,
          root3 * n.z * n.z * n.y, root6 * n.x * n.y * n.z};
}

void add(Cubic& to, double share, const Cubic& from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += share * from[i];
}

double product(const Cubic& a, const Cubic& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The mean of (n.e.n) n (n.g) over all directions n in the plane of the unit vectors u and v, for g = v,
/// times 8: what a sheet of modulus 1 does in the direction v. Eight directions give it exactly.
Cubic all_round(const dvec3& u, const dvec3& v) {
  Cubic sum{};
  for (int i = 0; i < 8; ++i) {
    const double angle = i * std::acos(-1.0) / 8.0;
    add(sum, std::sin(angle), cube(std::cos(angle) * u + std::sin(angle) * v));
  }
  return sum;
}

class Fit {
 public:
  Fit(const std::vector<dvec3>& position, const std::vector<std::array<std::uint32_t, 3>>& triangles,
      const std::vector<SheetPair>& pairs, const SpringSheet& sheet)
      : pairs_(pairs), residual_(position.size(), Cubic{}), importance_(position.size(), 0.0) {
    for (const auto& corners : triangles) add_triangle(position, corners);
    for (double& area : importance_) area = area > 0.0 ? 1.0 / area : 0.0;
    const double share = sheet.across / sheet.modulus;
    for (const SheetPair& pair : pairs) add_pair(position, pair, share);
  }

  /// Goes over the pairs until nothing changes, and returns stiffnesses for a modulus of 1.
  std::vector<double> run() {
    constexpr int most_sweeps = 400;
    constexpr double settled = 1e-4;
    double change = 1.0;
    for (int sweep = 0; sweep < most_sweeps && change > settled; ++sweep) {
      change = 0.0;
      for (std::size_t i = 0; i < springs_.size(); ++i) change = std::max(change, improve(i));
    }
    std::vector<double> stiffness;
    stiffness.reserve(springs_.size());
    for (const Spring& spring : springs_)
      stiffness.push_back(spring.length > 0.0 ? spring.w / (spring.length * spring.length) : most_stiffness);
    return stiffness;
  }

 private:
  static constexpr double most_stiffness = 8.0;
  /// An edge keeps this part of its share at least, or a mesh could come apart into hinges.
  static constexpr double least_share = 0.1;
  /// How much less a departure from equal shares counts than a force out of balance.
  static constexpr double preference = 1e-3;

  struct Spring {
    Cubic direction;
    double length, w, wanted, scale, least, most;
  };

  void add_triangle(const std::vector<dvec3>& position, const std::array<std::uint32_t, 3>& corners) {
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
      add(residual_[corners[i]], 0.5 * length, all_round(u, up / height));
      importance_[corners[i]] += length * height / 6.0;
    }
  }

  void add_pair(const std::vector<dvec3>& position, const SheetPair& pair, double share) {
    const dvec3 between = position[pair.b] - position[pair.a];
    const double length = glm::length(between), whole = 8.0 * pair.area;
    Spring spring{};
    spring.length = length;
    if (length > 0.0) {
      spring.direction = cube(between / length);
      spring.scale = std::max(whole, 1e-6 * length * length);
      spring.most = most_stiffness * length * length;
      spring.least = std::min(pair.across ? share * whole : least_share * (1.0 - share) * whole, spring.most);
      spring.wanted = std::clamp((pair.across ? share : 1.0 - share) * whole, spring.least, spring.most);
      move(pair, spring, spring.wanted);
    }
    springs_.push_back(spring);
  }

  void move(const SheetPair& pair, Spring& spring, double to) {
    const double force = (to - spring.w) / spring.length;
    add(residual_[pair.a], force, spring.direction);
    add(residual_[pair.b], -force, spring.direction);
    spring.w = to;
  }

  /// Moves one spring to its best value, and returns by what part of its share.
  double improve(std::size_t index) {
    Spring& spring = springs_[index];
    const SheetPair& pair = pairs_[index];
    if (!(spring.most > spring.least)) return 0.0;
    const double inverse = 1.0 / spring.length, weak = preference / (spring.scale * spring.scale);
    const double a = importance_[pair.a], b = importance_[pair.b];
    const double slope = inverse * (a * product(residual_[pair.a], spring.direction) -
                                    b * product(residual_[pair.b], spring.direction)) +
                         weak * (spring.w - spring.wanted);
    const double curvature = inverse * inverse * (a + b) + weak;
    const double before = spring.w;
    move(pair, spring, std::clamp(before - slope / curvature, spring.least, spring.most));
    return std::abs(spring.w - before) / spring.scale;
  }

  const std::vector<SheetPair>& pairs_;
  std::vector<Spring> springs_;
  std::vector<Cubic> residual_;     ///< [vertex_count] force of the springs less that of the sheet
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
