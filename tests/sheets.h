// One square sheet of springs, cut into triangles in several ways, and how far it gives way to loads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "server/reference/reference.h"
#include "server/reference/rest_shape.h"
#include "tests/small_scenes.h"

namespace clothlab::test {

enum class Cut { grid, one_diagonal, other_diagonal, alternating, crossed, irregular };
inline constexpr Cut all_cuts[] = {Cut::grid,        Cut::one_diagonal, Cut::other_diagonal,
                                   Cut::alternating, Cut::crossed,      Cut::irregular};

inline const char* name_of(Cut cut) {
  constexpr const char* names[] = {"grid",        "its triangles", "other diagonals",
                                   "alternating", "crossed",       "irregular"};
  return names[static_cast<int>(cut)];
}

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Turns diagonals of pairs of triangles in the x-z plane until no vertex is within the circle around a
/// triangle beside it (Lawson 1977).
inline void make_delaunay(const std::vector<glm::dvec3>& v, Triangles& triangles) {
  const auto angle_at = [&](std::uint32_t at, std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 p = v[a] - v[at], q = v[b] - v[at];
    return std::atan2(std::abs(p.z * q.x - p.x * q.z), glm::dot(p, q));
  };
  for (bool turned = true; turned;) {
    turned = false;
    for (std::size_t s = 0; s < triangles.size(); ++s)
      for (std::size_t t = s + 1; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) {
            auto &one = triangles[s], &other = triangles[t];
            const std::uint32_t a = one[i], b = one[(i + 1) % 3], c = one[(i + 2) % 3],
                                d = other[(j + 2) % 3];
            if (other[j] != b || other[(j + 1) % 3] != a) continue;
            if (angle_at(c, a, b) + angle_at(d, a, b) < std::acos(-1.0) + 1e-9) continue;
            one = {a, d, c};
            other = {d, b, c};
            turned = true;
          }
  }
}

/// A sheet of 1 m x 1 m in the x-z plane with `cells` cells a side. Its border has the same vertices whatever
/// the cut.
inline scene::Scene sheet_of(Cut cut, int cells, const scene::Springs& springs) {
  scene::Scene scene = bare_scene(scene::Method::implicit_euler, 1e-3);
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.material = springs;
  cloth.mass = {scene::Mass::Kind::area_density, 0.2};
  const int n = cells + 1;
  if (cut == Cut::grid) {
    cloth.mesh = scene::Grid{n, n, 1.0, 1.0};
    cloth.transform.translate.x = 0.5;
    return scene;
  }
  scene::TriangleMesh mesh;
  const double h = 1.0 / cells;
  std::mt19937 random(7);
  const auto jitter = [&] { return 0.7 * h * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) {
      glm::dvec3 place(column * h, 0.0, row * h);
      if (cut == Cut::irregular && row > 0 && row < cells && column > 0 && column < cells)
        place += glm::dvec3(jitter(), 0.0, jitter());
      mesh.vertices.push_back(place);
    }
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const auto a = static_cast<std::uint32_t>(row * n + column), b = a + static_cast<std::uint32_t>(n),
                 c = b + 1, d = a + 1;
      if (cut == Cut::crossed) {
        const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back({(column + 0.5) * h, 0.0, (row + 0.5) * h});
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}})
          mesh.triangles.push_back({p, q, middle});
      } else if (cut == Cut::other_diagonal || (cut == Cut::alternating && (row + column) % 2 != 0)) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  if (cut == Cut::irregular) make_delaunay(mesh.vertices, mesh.triangles);
  cloth.mesh = mesh;
  return scene;
}

/// A load: gravity on a sheet that is held at parts of its border.
struct Load {
  const char* name;
  glm::dvec3 gravity;  ///< [m/s^2]
  std::vector<scene::AtBox> held;
};

inline std::vector<Load> loads(double g) {
  const auto box = [](double x0, double x1, double z0, double z1) {
    constexpr double near = 1e-6;
    return scene::AtBox{{x0 - near, -1.0, z0 - near}, {x1 + near, 1.0, z1 + near}};
  };
  const scene::AtBox left = box(0, 0, 0, 1), right = box(1, 1, 0, 1), top = box(0, 1, 0, 0),
                     bottom = box(0, 1, 1, 1);
  const double half = g * std::sqrt(0.5);
  return {{"stretch", {0, 0, g}, {top}},
          {"across", {g, 0, 0}, {left}},
          {"shear", {g, 0, 0}, {top, bottom}},
          {"diagonal", {half, 0, half}, {box(0, 0.25, 0, 0), box(0, 0, 0, 0.25)}},
          {"diagonal 2", {-half, 0, half}, {box(0.75, 1, 0, 0), box(1, 1, 0, 0.25)}},
          {"sag", {0, -g, 0}, {left, right, top, bottom}}};
}

/// How far the sheet's mass moves along a load, at rest [m]; NaN if no rest shape is found. `change` may
/// change the world's model first.
template <class Change>
double yielding(scene::Scene scene, const Load& load, Change&& change) {
  scene.gravity = load.gravity;
  for (const scene::AtBox& held : load.held) scene.cloths[0].pins.push_back({held, {}});
  Result<reference::World> world = reference::make_world(scene, 0.0);
  if (!world) return std::nan("");
  change(world->model);
  std::vector<glm::dvec3> start = world->model.rest_position;
  // Off the flat shape, where gravity has nothing to act against.
  if (load.gravity.y != 0.0)
    for (glm::dvec3& p : start) p.y -= 0.1 * std::sin(3.14159 * p.x) * std::sin(3.14159 * p.z);
  const Result<reference::RestShape> rest = reference::rest_shape(*world, start, {});
  if (!rest) return std::nan("");
  double sum = 0.0, mass = 0.0;
  const glm::dvec3 along = glm::normalize(load.gravity);
  for (std::size_t i = 0; i < start.size(); ++i) {
    sum += world->model.mass[i] * glm::dot(rest->position[i] - world->model.rest_position[i], along);
    mass += world->model.mass[i];
  }
  return sum / mass;
}
inline double yielding(const scene::Scene& scene, const Load& load) {
  return yielding(scene, load, [](model::Model&) {});
}

}  // namespace clothlab::test
