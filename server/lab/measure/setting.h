// A way to step a scene: what the lab measures, compares and hands back as a patch.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "server/scene/scene.h"

namespace clothlab::lab {

using nlohmann::json;

struct Setting {
  scene::Method method = scene::Method::symplectic_euler;
  double dt = 0.001;        ///< [s]
  int iterations = 1;       ///< where the method iterates
  double tolerance = 1e-4;  ///< of implicit Euler's linear solver
  bool operator==(const Setting&) const = default;
};

/// The scene's own; what the method does not look at has its default, so that equal settings are equal.
Setting setting_of(const scene::Scene& scene);

/// The scene stepped that way.
scene::Scene with(scene::Scene scene, const Setting& setting);

/// {"solver": {"method", "dt", ...}}, a merge patch for the scene; without what the method does not look at.
json patch(const Setting& setting);

/// {"method", "dt_s", "iterations", "tolerance"}; null for what the method does not look at.
json to_json(const Setting& setting);

/// "verlet, dt 0.76 ms" or "xpbd, dt 1.1 ms, 4 iterations".
std::string text(const Setting& setting);

}  // namespace clothlab::lab
