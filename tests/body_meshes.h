// Bodies of triangles for tests: a ball, a box, a sheet.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/scene/scene.h"

namespace clothlab::test {

using Corners = std::array<std::uint32_t, 3>;

/// An icosahedron of 12 vertices whose triangles are cut into four `times` times, on a ball of 1 m about the
/// origin; counter-clockwise seen from outside.
inline scene::TriangleMesh ball_mesh(int times) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  scene::TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (; times > 0; --times) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (fresh) mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      return at->second;
    };
    std::vector<Corners> cut;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Corners& part : {Corners{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
        cut.push_back(part);
    }
    mesh.triangles = std::move(cut);
  }
  for (glm::dvec3& vertex : mesh.vertices) vertex = glm::normalize(vertex);
  return mesh;
}

/// A cube with corners at +-1 m, counter-clockwise seen from outside.
inline scene::TriangleMesh cube_mesh() {
  scene::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back((i & 1) * 2 - 1, (i & 2) - 1, (i & 4) / 2 - 1);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// An open square of 1 m in the x-z plane, about the origin: `columns` x `columns` squares of two triangles.
inline scene::TriangleMesh plate_mesh(std::uint32_t columns) {
  scene::TriangleMesh mesh;
  for (std::uint32_t row = 0; row <= columns; ++row)
    for (std::uint32_t column = 0; column <= columns; ++column)
      mesh.vertices.emplace_back(column / double(columns) - 0.5, 0.0, row / double(columns) - 0.5);
  for (std::uint32_t row = 0; row < columns; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t a = row * (columns + 1) + column, b = a + columns + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({b + 1, a + 1, a});
    }
  return mesh;
}

/// Of a mesh the triangles that lie below the origin: of a ball, an open bowl.
inline scene::TriangleMesh lower_half(scene::TriangleMesh mesh) {
  std::erase_if(mesh.triangles, [&](const Corners& t) {
    return mesh.vertices[t[0]].y + mesh.vertices[t[1]].y + mesh.vertices[t[2]].y > 0.0;
  });
  std::map<std::uint32_t, std::uint32_t> kept;
  std::vector<glm::dvec3> vertices;
  for (Corners& triangle : mesh.triangles)
    for (std::uint32_t& corner : triangle) {
      const auto [at, fresh] = kept.try_emplace(corner, static_cast<std::uint32_t>(vertices.size()));
      if (fresh) vertices.push_back(mesh.vertices[corner]);
      corner = at->second;
    }
  mesh.vertices = std::move(vertices);
  return mesh;
}

/// The same surface, its other side outside.
inline scene::TriangleMesh turned_over(scene::TriangleMesh mesh) {
  for (Corners& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Both meshes as parts of one.
inline scene::TriangleMesh together(scene::TriangleMesh mesh, const scene::TriangleMesh& other,
                                    double scale = 1.0, const glm::dvec3& moved = glm::dvec3(0.0)) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const glm::dvec3& vertex : other.vertices) mesh.vertices.push_back(scale * vertex + moved);
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  return mesh;
}

inline scene::Collider body_of(scene::TriangleMesh mesh, const scene::Transform& transform = {},
                               const scene::Motion& motion = {}, const std::string& name = "body") {
  return {name, scene::Body{std::make_shared<const scene::TriangleMesh>(std::move(mesh)), transform}, 0.3,
          0.0, motion};
}

}  // namespace clothlab::test
