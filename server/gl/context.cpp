#include "server/gl/context.h"

#include <glad/egl.h>
#include <glad/gl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <mutex>
#include <string_view>

#include "server/gl/checked_calls.h"
#include "server/gl/devices.h"
#include "server/gl/software/displays.h"

namespace clothlab::gl {

namespace {

std::string text(const char* value) {
  return value ? value : "";
}

std::string gl_text(GLenum name) {
  return text(reinterpret_cast<const char*>(glGetString(name)));
}

bool has_extension(std::string_view wanted) {
  GLint count = 0;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i)
    if (wanted == reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i))))
      return true;
  return false;
}

/// The memory of a device whose context is current [bytes]; 0 if the driver does not tell.
std::uint64_t memory_of(const Device& device) {
  if (device.software)
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  if (!has_extension("GL_NVX_gpu_memory_info")) return 0;  // NVIDIA's driver and Mesa's for AMD have it
  constexpr GLenum dedicated_kilobytes = 0x9047;           // GPU_MEMORY_INFO_DEDICATED_VIDMEM_NVX
  GLint kilobytes = 0;
  glGetIntegerv(dedicated_kilobytes, &kilobytes);
  return 1024 * static_cast<std::uint64_t>(std::max(kilobytes, 0));
}

EGLDisplay open_display(EGLDeviceEXT device) {
  if (!eglGetPlatformDisplayEXT) return EGL_NO_DISPLAY;
  if (device) return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
}

EGLContext open_context(EGLDisplay display) {
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                               // Last, to be left out below for drivers that cannot report a reset:
                               // `lost` is then never true.
                               EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET,
                               EGL_NONE};
  if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
  EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (context != EGL_NO_CONTEXT) return context;
  std::vector<EGLint> without(std::begin(attributes), std::end(attributes) - 3);
  without.push_back(EGL_NONE);
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, without.data());
}

struct Opened {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

/// Makes a context on the device by this display and makes it current; fills in the device's names or its
/// problem.
Opened open(Device& device, EGLDisplay display) {
  Opened opened{display, EGL_NO_CONTEXT};
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
    device.problem = "EGL cannot open the device";
    return {};
  }
  gladLoaderLoadEGL(opened.display);  // each display has its own extensions
  opened.context = open_context(opened.display);
  if (opened.context == EGL_NO_CONTEXT) {
    device.problem = "no OpenGL 4.5 core context";
    return {};
  }
  if (!eglMakeCurrent(opened.display, EGL_NO_SURFACE, EGL_NO_SURFACE, opened.context) ||
      !gladLoadGL(function_of)) {
    device.problem = "the OpenGL context cannot be made current without a surface";
    eglDestroyContext(opened.display, opened.context);
    return {};
  }
  begin_context_checks();
  device.name = gl_text(GL_RENDERER);
  device.version = gl_text(GL_VERSION);
  device.vendor = gl_text(GL_VENDOR);
  // Some drivers list Mesa's rasteriser as an ordinary device.
  device.software = device.software || software_renderer();
  if (device.software) software::opened(display);
  device.memory = memory_of(device);
  device.usable = true;
  return opened;
}

void close(const Opened& opened) {
  eglMakeCurrent(opened.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(opened.display, opened.context);
}

Opened open(Candidate& candidate) {
  return open(candidate.device, open_display(candidate.handle));
}

/// Opens the same software device through the display of `threads`, because in Mesa each display has its own
/// helper threads. Empty if that display leads to another device.
std::optional<Opened> open_apart(Candidate candidate, HelperThreads threads, std::optional<bool> helped,
                                 std::unique_lock<std::mutex>& lock) {
  const std::string wanted = candidate.device.name;
  candidate.device.usable = false;
  const EGLDisplay display = software::display_of(candidate.handle, threads);
  if (helped) software::reopen(display, *helped, lock);
  const Opened opened = open(candidate.device, display);
  if (candidate.device.usable && candidate.device.name == wanted) return opened;
  if (candidate.device.usable) close(opened);
  return std::nullopt;
}

/// "0 (/dev/dri/card0), 1 (software)"
std::string in_words(const std::vector<Candidate>& all) {
  std::string words;
  for (const auto& [handle, device] : all) {
    words += (words.empty() ? "" : ", ") + std::to_string(device.index);
    if (!device.node.empty() || device.software)
      words += " (" + (device.software ? "software" : device.node) + ")";
  }
  return words;
}

}  // namespace

std::string renderer_name() {
  return gl_text(GL_RENDERER);
}

Result<std::vector<Device>> list_devices() {
  const std::lock_guard lock(egl_mutex());
  if (Status loaded = load_egl(); !loaded) return loaded.error();
  std::vector<Device> devices;
  for (Candidate& candidate : candidates()) {
    if (const Opened opened = open(candidate); candidate.device.usable) close(opened);
    devices.push_back(candidate.device);
  }
  return devices;
}

Result<std::unique_ptr<Context>> Context::create(std::optional<int> gpu, HelperThreads threads,
                                                 std::optional<bool> helped) {
  std::unique_lock lock(egl_mutex());
  if (Status loaded = load_egl(); !loaded) return loaded.error();
  std::vector<Candidate> all = candidates();
  const int count = static_cast<int>(all.size());
  if (gpu && (*gpu < 0 || *gpu >= count))
    return Error{"--gpu", std::to_string(*gpu), "one of " + in_words(all) + "; `clothlab info` tells more"};

  std::string problems;
  // First pass: hardware (or the device asked for); second pass: the software rasteriser.
  for (const bool software : {false, true}) {
    for (Candidate& candidate : all) {
      if (gpu ? candidate.device.index != *gpu || software : candidate.device.software != software) continue;
      Opened opened = open(candidate);
      if (!candidate.device.usable) {
        problems += (problems.empty() ? " device " : ", device ") + std::to_string(candidate.device.index) +
                    ": " + candidate.device.problem;
        continue;
      }
      if (threads != HelperThreads::none && candidate.handle && candidate.device.software) {
        close(opened);
        const std::optional<Opened> apart = open_apart(candidate, threads, helped, lock);
        opened = apart ? *apart : open(candidate);
      }
      std::unique_ptr<Context> context(new Context);
      context->device_ = candidate.device;
      context->display_ = opened.display;
      context->context_ = opened.context;
      software::note_device(gpu, candidate.device.software);
      if (candidate.device.software) software::context_made(opened.display);
      return context;
    }
  }
  return Error{"OpenGL", "no device offers OpenGL 4.5 core:" + problems, install_hint};
}

Context::~Context() {
  if (eglGetCurrentContext() == context_)
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  if (!device_.software) return;
  const std::lock_guard lock(egl_mutex());
  software::context_gone(display_);
}

bool Context::lost() const {
  lost_ = lost_ || glGetGraphicsResetStatus() != GL_NO_ERROR;
  return lost_;
}

Status Context::make_current() {
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return ok();
  return Error{"OpenGL", "the context cannot be made current", "is it current on another thread?"};
}

void Context::release_current() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace clothlab::gl
