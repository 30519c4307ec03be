// Shared by the stepping benchmarks: the seed scene on grids of other sizes, and a clock.
#pragma once

#include <chrono>

#include "server/scene/scene.h"

namespace clothlab::bench {

/// The seed scene with `side` vertices per side, without self-collision.
inline scene::Scene seed_of(int side) {
  scene::Scene scene;
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{side, side, 1.0, 1.0};
  cloth.transform.translate = {0.0, 1.0, 0.0};
  const scene::Oscillate swing{{0.0, 0.0, 1.0}, 0.2, 0.5};
  cloth.pins = {{scene::AtCorner{0, 0}, swing}, {scene::AtCorner{side - 1, 0}, swing}};
  scene.cloths = {cloth};
  scene.colliders = {{"ball", scene::Sphere{{0.0, 0.6, 0.0}, 0.25}, 0.3, 0.0, {}}};
  return scene;
}

inline double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace clothlab::bench
