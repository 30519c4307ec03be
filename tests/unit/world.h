// A scene for the double-precision reference, without collisions.
#pragma once

#include "server/reference/reference.h"

namespace clothlab {

inline reference::World world_of(const scene::Scene& scene) {
  return *reference::make_world(scene, 0.0);
}

}  // namespace clothlab
