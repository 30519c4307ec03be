// The helper threads of software OpenGL (gl/context.h) at the priority of what they compute.
#pragma once

#include <optional>

#include "server/gl/context.h"

namespace clothlab::session {

/// Creates the helper threads of `sessions` at nice 5, or those of `lab` at nice 19, the lowest priority.
/// They inherit the priority of the thread that makes the first context for them: so call this before any
/// other context of `threads`. Every call after the first, and one for another display, does nothing.
void make_helper_threads(std::optional<int> gpu, gl::HelperThreads threads);

}  // namespace clothlab::session
