// Meshes that are curved at rest, for tests of finite elements.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <utility>

#include "server/scene/scene.h"

namespace clothlab::test {

using glm::dvec3;

inline constexpr double pi = 3.14159265358979323846;

/// A rectangle of `width` x `length` [m] in the x-z plane, as a grid of cells or, with `shift` (a share of a
/// cell), with inner vertices moved and diagonals of either direction.
inline scene::TriangleMesh rectangle(int columns, int rows, double width, double length, double shift = 0.0) {
  scene::TriangleMesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> either(-shift, shift);
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column) {
      const bool inner = row > 0 && row < rows && column > 0 && column < columns;
      const double x = column + (inner ? either(random) : 0.0), z = row + (inner ? either(random) : 0.0);
      mesh.vertices.push_back({x * width / columns, 0.0, z * length / rows});
    }
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * (columns + 1) + column);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto a = at(column, row), b = at(column, row + 1), c = at(column + 1, row + 1),
                 d = at(column + 1, row);
      if (shift > 0.0 && random() % 2) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  return mesh;
}

/// The rectangle rolled up along x, to a cylinder of this curvature [1/m]; lengths stay as they are.
inline std::vector<dvec3> rolled(const std::vector<dvec3>& flat, double curvature) {
  std::vector<dvec3> result;
  for (const dvec3& p : flat) {
    const double angle = curvature * p.x;
    result.push_back(curvature == 0.0 ? p
                                      : dvec3(std::sin(angle) / curvature,
                                              p.y - (1.0 - std::cos(angle)) / curvature, p.z));
  }
  return result;
}

inline scene::TriangleMesh cylinder(int columns, int rows, double width, double length, double curvature,
                                    double shift = 0.0) {
  scene::TriangleMesh mesh = rectangle(columns, rows, width, length, shift);
  mesh.vertices = rolled(mesh.vertices, curvature);
  return mesh;
}

/// A strip folded at a right angle in its middle, along z.
inline scene::TriangleMesh folded(int columns, int rows, double width, double length) {
  scene::TriangleMesh mesh = rectangle(columns, rows, width, length);
  for (dvec3& p : mesh.vertices)
    if (p.x > 0.5 * width) p = dvec3(0.5 * width, 0.5 * width - p.x, p.z);
  return mesh;
}

/// A sphere of radius 0.1 m: an octahedron, each of whose triangles is divided into 4 some times. If `half`,
/// its upper half.
inline scene::TriangleMesh sphere(int divisions, bool half) {
  constexpr double radius = 0.1;
  scene::TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}, {0, -1, 0}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    mesh.triangles.push_back({k, (k + 1) % 4, 4});
    if (!half) mesh.triangles.push_back({(k + 1) % 4, k, 5});
  }
  if (half) mesh.vertices.pop_back();
  for (int n = 0; n < divisions; ++n) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(glm::normalize(mesh.vertices[a] + mesh.vertices[b]));
      return found->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& part : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(part);
    }
    mesh.triangles = finer;
  }
  for (dvec3& p : mesh.vertices) p *= radius;
  return mesh;
}

/// Two half cylinders and a flat strip that meet at one edge of three triangles, and a hole in the strip.
inline scene::TriangleMesh seam() {
  scene::TriangleMesh mesh = cylinder(6, 4, 0.3, 0.2, 10.0);
  const auto join = [&](const scene::TriangleMesh& more, double turn) {
    std::vector<std::uint32_t> number;
    for (const dvec3& p : more.vertices) {
      const bool shared = p.x == 0.0;
      number.push_back(shared ? static_cast<std::uint32_t>(std::lround(p.z / 0.05) * 7)
                              : static_cast<std::uint32_t>(mesh.vertices.size()));
      if (!shared)
        mesh.vertices.push_back(
            {std::cos(turn) * p.x - std::sin(turn) * p.y, std::sin(turn) * p.x + std::cos(turn) * p.y, p.z});
    }
    for (std::size_t t = 0; t < more.triangles.size(); ++t)
      if (turn < 3.0 || t < 18 || t > 20) {
        const auto& [a, b, c] = more.triangles[t];
        mesh.triangles.push_back({number[a], number[b], number[c]});
      }
  };
  join(cylinder(6, 4, 0.3, 0.2, -10.0), 2.0);
  join(rectangle(6, 4, 0.3, 0.2), 4.0);
  return mesh;
}

inline scene::Cloth curved_cloth(const scene::TriangleMesh& mesh, const scene::Fem& material) {
  scene::Cloth cloth;
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::area_density, 0.2};
  cloth.material = material;
  return cloth;
}

}  // namespace clothlab::test
