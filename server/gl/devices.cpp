#include "server/gl/devices.h"

#include <string>

#include "server/gl/software/displays.h"

namespace clothlab::gl {

const char* const install_hint =
    "install Mesa's software OpenGL: apt-get install libegl1 libgl1-mesa-dri (or the GPU's own driver)";

std::mutex& egl_mutex() {
  static std::mutex mutex;
  return mutex;
}

Status load_egl() {
  static const int version = gladLoaderLoadEGL(nullptr);
  if (version == 0) return Error{"EGL", "libEGL.so.1 could not be loaded", install_hint};
  return ok();
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> found;
  EGLint count = 0;
  if (eglQueryDevicesEXT && eglQueryDevicesEXT(0, nullptr, &count) && count > 0) {
    std::vector<EGLDeviceEXT> handles(static_cast<std::size_t>(count));
    eglQueryDevicesEXT(count, handles.data(), &count);
    for (int index = 0; index < count; ++index) {
      Candidate candidate{handles[static_cast<std::size_t>(index)], {}};
      candidate.device.index = index;
      const auto text = [&](EGLint name) {
        const char* value = eglQueryDeviceStringEXT(candidate.handle, name);
        return std::string(value ? value : "");
      };
      const std::string extensions = text(EGL_EXTENSIONS);
      candidate.device.software = extensions.find("EGL_MESA_device_software") != std::string::npos;
      if (extensions.find("EGL_EXT_device_drm") != std::string::npos)
        candidate.device.node = text(EGL_DRM_DEVICE_FILE_EXT);
      found.push_back(candidate);
    }
  }
  if (found.empty()) {
    Candidate surfaceless;
    surfaceless.device.software = true;
    found.push_back(surfaceless);
  }
  if (software::plays_gpu())
    for (Candidate& candidate : found) candidate.device.software = false;
  return found;
}

}  // namespace clothlab::gl
