// The EGL devices of this machine, before a context is made on one; for the files of this folder.
#pragma once

#include <glad/egl.h>

#include <mutex>
#include <vector>

#include "server/gl/context.h"

namespace clothlab::gl {

/// Guards the EGL entry points, which are process-wide: two threads must not load them at once.
std::mutex& egl_mutex();

/// Loads libEGL, once.
Status load_egl();

struct Candidate {
  EGLDeviceEXT handle = nullptr;  ///< null: the surfaceless platform, where devices cannot be listed
  Device device;
};
/// Every EGL device in the driver's order, without what only a context tells. EGL must be loaded.
std::vector<Candidate> candidates();

/// What to do where no device offers OpenGL.
extern const char* const install_hint;

}  // namespace clothlab::gl
