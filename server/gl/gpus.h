// GPUs that the machine has and OpenGL does not offer.
#pragma once

#include <string>
#include <vector>

#include "server/gl/context.h"

namespace clothlab::gl {

/// For each maker of GPUs (NVIDIA, AMD, Intel) that the machine's files show, and of
/// which no usable device is listed: what was found, and what to pass to the container or to install. Looks
/// at /dev, /proc and /sys; CLOTHLAB_GPU_FILES=FOLDER in the environment, for tests, has others in their
/// place.
std::vector<std::string> gpus_without_opengl(const std::vector<Device>& listed);

}  // namespace clothlab::gl
