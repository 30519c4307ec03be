// A setting: the way in which a scene is stepped. The lab measures settings, compares them and returns them
// as patches.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "server/scene/scene.h"

namespace clothlab::lab {

using nlohmann::json;

struct Setting {
  scene::Method method = scene::Method::symplectic_euler;
  double dt = 0.001;        ///< [s]
  int iterations = 1;       ///< a step; only for methods that iterate
  double tolerance = 1e-4;  ///< of the linear solver; only for implicit Euler
  bool operator==(const Setting&) const = default;
};

/// The scene's own setting. Fields that its method does not use have their defaults, so that settings with
/// the same effect compare equal.
Setting setting_of(const scene::Scene& scene);

/// The scene with its solver set to `setting`.
scene::Scene with(scene::Scene scene, const Setting& setting);

/// {"solver": {"method", "dt", ...}}, a merge patch for the scene, with only the fields that the method uses.
json patch(const Setting& setting);

/// {"method", "dt_s", "iterations", "tolerance"}; null for a field that the method does not use.
json to_json(const Setting& setting);

/// For people: "verlet, dt 0.76 ms" or "xpbd, dt 1.1 ms, 4 iterations".
std::string text(const Setting& setting);

}  // namespace clothlab::lab
