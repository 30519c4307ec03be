// Estimates the time that a step of a scene takes, from the scene's numbers alone.
#pragma once

#include "server/scene/scene.h"

namespace clothlab::sim {

/// Estimated time of one step on one core with software OpenGL [s], right within a factor of about three:
/// enough to tell if such a machine can step the scene in real time.
double expected_step_seconds(const scene::Scene& scene);

/// True if software OpenGL steps the scene faster on the thread that calls than on helper threads, whose
/// start and end take longer than they save.
bool needs_no_helper_threads(const scene::Scene& scene);

}  // namespace clothlab::sim
