// What a step of a scene is likely to cost, told from its numbers alone.
#pragma once

#include "server/scene/scene.h"

namespace clothlab::sim {

/// Seconds on one core of software OpenGL, right within a factor of some three: enough to tell a scene that
/// such a machine steps in real time from one that it cannot.
double expected_step_seconds(const scene::Scene& scene);

}  // namespace clothlab::sim
