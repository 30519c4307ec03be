// Cloths that lie on planes and spheres, as plain data, for tests of contact.
#pragma once

#include <cmath>
#include <numbers>

#include "server/scene/scene.h"

namespace clothlab::test {

inline constexpr double standard_gravity = 9.81;

/// A free cloth of 0.4 m, 0.01 kg per vertex, structural springs of 800 N/m, that lies on a plane sloping
/// down along -x by `degrees`: the plane is level and gravity leans.
inline scene::Scene sheet_on_slope(double degrees, double friction, int side = 9) {
  scene::Scene scene;
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{side, side, 0.4, 0.4};
  cloth.mass = {scene::Mass::Kind::per_vertex, 0.01};
  cloth.material = scene::Springs{800.0, 0.0, 0.0, 0.0};
  const double angle = degrees * std::numbers::pi / 180.0;
  scene.gravity = {-standard_gravity * std::sin(angle), -standard_gravity * std::cos(angle), 0.0};
  scene.colliders = {{"ground", scene::Plane{{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}, friction, 0.0, {}}};
  return scene;
}

/// The same cloth, dropped from `height` [m] onto a sphere of 0.2 m.
inline scene::Scene sheet_over_sphere(double height, double friction) {
  scene::Scene scene = sheet_on_slope(0.0, friction);
  scene.cloths[0].transform.translate = {0.01, height, 0.02};
  scene.colliders = {{"ball", scene::Sphere{{0.0, -0.2, 0.0}, 0.2}, friction, 0.0, {}}};
  return scene;
}

}  // namespace clothlab::test
