// Which methods have a meaning for a scene.
#pragma once

#include <vector>

#include "server/base/result.h"
#include "server/scene/scene.h"

namespace clothlab::scene {

/// Why the scene cannot be stepped by `method`, and by what it can instead; null: it can.
const char* unsuited(Method method, const Scene& scene);

/// The methods of `wanted`, or all that suit the scene if `wanted` is empty. Error: one of `wanted` does not.
Result<std::vector<Method>> suited_methods(const Scene& scene, const std::vector<Method>& wanted);

}  // namespace clothlab::scene
