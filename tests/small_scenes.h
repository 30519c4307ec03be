// Scenes whose motion has a closed form, as plain data, for tests of the reference and of the GPU. A grid has
// at least two columns: each scene is two copies side by side that move as one.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "server/scene/method.h"
#include "server/scene/scene.h"
#include "server/scene/suited.h"

namespace clothlab::test {

inline scene::Scene bare_scene(scene::Method method, double dt) {
  scene::Scene scene;
  scene.gravity = glm::dvec3(0.0);
  scene.solver = {.method = method, .dt = dt};
  return scene;
}

/// A strip of `columns` x `rows` vertices of 1 kg, `height` long, hung by its first row; no springs yet.
inline scene::Scene hung_strip(scene::Method method, double dt, int columns, int rows, double width,
                               double height) {
  scene::Scene scene = bare_scene(method, dt);
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{columns, rows, width, height};
  cloth.mass = {scene::Mass::Kind::per_vertex, 1.0};
  cloth.material = scene::Springs{0.0, 0.0, 0.0, 0.0};
  cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
  return scene;
}

/// One spring of 1 m, 16 N/m, along z, with 1 kg at its end: omega = 4 / s. It starts unstretched, at rest,
/// `amplitude` [m] from its balance under gravity along z. Damping ratio z = damping / 8. It is a bend spring
/// over a row that is pinned, too: no spring joins the two copies.
inline scene::Scene one_spring(scene::Method method, double dt, double damping = 0.0,
                               double amplitude = 0.1) {
  scene::Scene scene = hung_strip(method, dt, 2, 3, 1.0, 1.0);
  scene.gravity = {0.0, 0.0, 16.0 * amplitude};
  scene.cloths[0].material = scene::Springs{0.0, 0.0, 16.0, damping};
  scene.cloths[0].pins.push_back({scene::AtEdge{scene::AtEdge::Line::row, 1}, {}});
  return scene;
}
inline constexpr std::size_t spring_end = 4;      ///< a vertex of one_spring that moves
inline constexpr double spring_omega = 4.0;       ///< [1/s]
inline constexpr double spring_balance = 1.1;     ///< its z at balance [m]
inline constexpr double spring_amplitude = -0.1;  ///< z - balance at the start [m]

/// A chain of `links` springs of 1/links m along z from a pinned end, `mass` at each node [kg], k [N/m] each.
/// Springs across join the two copies; they stay at rest.
inline scene::Scene chain(scene::Method method, double dt, int links, double k, double mass) {
  scene::Scene scene = hung_strip(method, dt, 2, links + 1, 1.0, 1.0);
  scene.cloths[0].mass.value = mass;
  scene.cloths[0].springs().structural = k;
  return scene;
}

/// A rod of 1 m that swings from a pinned end, let go at `degrees` from hanging down: a spring of stiffness k
/// [N/m] with 1 kg at its end, in the y-z plane with gravity of 9.81 m/s^2. A rod's period is 2 pi sqrt(1 m /
/// g) times its factor.
inline scene::Scene pendulum(scene::Method method, double dt, double degrees, double k) {
  scene::Scene scene = one_spring(method, dt);
  const double angle = degrees * std::acos(-1.0) / 180.0;
  scene.gravity =
      // the grid's +z axis makes this angle with gravity
      9.81 * glm::dvec3(0.0, -std::sin(angle), std::cos(angle));
  scene.cloths[0].springs().bend = k;
  return scene;
}

/// The cloth of the work-precision table (tests/README.md): 17 x 17 over 0.5 m, 1.4648e-4 kg a vertex, 100
/// N/m everywhere, two pinned corners, no damping. Its unit of time is sqrt(m/k).
inline scene::Scene swinging_cloth(scene::Method method, double dt) {
  scene::Scene scene = bare_scene(method, dt);
  scene.gravity = {0.0, -9.81, 0.0};
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{17, 17, 0.5, 0.5};
  cloth.mass = {scene::Mass::Kind::per_vertex, 1.4648e-4};
  cloth.material = scene::Springs{100.0, 100.0, 100.0, 0.0};
  cloth.pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{16, 0}, {}}};
  return scene;
}
inline const double cloth_unit = std::sqrt(1.4648e-4 / 100.0);  ///< [s]

/// A sheet of finite elements, orthotropic and turned, of as many vertices as `side` has along each side of
/// 0.25 m; nothing holds it and nothing pulls it. Its fastest vibration is about 4400 rad/s with a side of 9.
inline scene::Scene sheet_of_elements(scene::Method method, double dt, int side, double damping = 0.0) {
  scene::Scene scene = bare_scene(method, dt);
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{side, side, 0.25, 0.25};
  cloth.mass = {scene::Mass::Kind::area_density, 0.2};
  cloth.material = scene::Fem{60.0, 40.0, 0.3, 15.0, {1e-5, 4e-5, std::nullopt}, damping, 30.0, std::nullopt};
  return scene;
}

/// The methods that step a sheet of finite elements.
inline std::vector<scene::Method> sheet_methods() {
  return *scene::suited_methods(sheet_of_elements(scene::Method::verlet, 1e-4, 3), {});
}

/// Gives a method that iterates steps of 2 ms, and iterations enough for sheets of some hundred vertices.
inline void iterate_well(scene::Solver& solver) {
  if (!scene::iterates(solver.method)) return;
  solver.dt = 2e-3;
  solver.iterations = scene::solves(solver.method) ? 20 : 30;
  solver.tolerance = 1e-6;
}

}  // namespace clothlab::test
