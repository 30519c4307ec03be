// Estimates the time that a step of a scene takes, from the scene's numbers alone.
#pragma once

#include "server/scene/scene.h"

namespace clothlab::sim {

/// Estimated time of one step on one core with software OpenGL [s], right within a factor of about three:
/// enough to tell if such a machine can step the scene in real time.
double expected_step_seconds(const scene::Scene& scene);

/// The share of such a core's time that the scene takes in real time.
double expected_share(const scene::Scene& scene);

}  // namespace clothlab::sim
