#include "server/gl/context.h"

#include <glad/egl.h>
#include <glad/gl.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>

#include "server/gl/checked_calls.h"

namespace clothlab::gl {

namespace {

constexpr const char* install_hint =
    "install Mesa's software OpenGL: apt-get install libegl1 libgl1-mesa-dri (or the GPU's own driver)";

/// Guards the EGL entry points, which are process-wide: two threads must not load them at once.
std::mutex egl_mutex;

struct Candidate {
  EGLDeviceEXT handle = nullptr;  ///< null: the surfaceless platform, where devices cannot be listed
  Device device;
  HelperThreads threads = HelperThreads::none;
};

struct OpenDisplay {
  bool helped = false;  ///< software OpenGL computes on helper threads for it
  int contexts = 0;     ///< that exist
};
/// The displays that are open. Guarded by egl_mutex.
std::map<EGLDisplay, OpenDisplay>& open_displays() {
  static std::map<EGLDisplay, OpenDisplay> displays;
  return displays;
}
/// Notified when a context has gone.
std::condition_variable context_gone;

/// The number of helper threads that the environment asks for, by default one for each core; on a single core
/// there are none.
std::string wanted_helpers() {
  const char* number = std::getenv("LP_NUM_THREADS");
  const unsigned cores = std::thread::hardware_concurrency();
  return number ? number : std::to_string(cores > 1 ? cores : 0);
}
/// The same as the program began; set by `compute_without_helper_threads`.
std::string helpers_at_first;

/// Opens the display, if it is not open yet: only then does Mesa read LP_NUM_THREADS.
bool initialize(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return false;
  open_displays().emplace(display, OpenDisplay{std::atoi(wanted_helpers().c_str()) != 0, 0});
  return true;
}

/// Opens the display anew if it does not compute with, or without, helper threads as wanted. Waits until no
/// context of it exists.
void reopen(EGLDisplay display, bool helped, std::unique_lock<std::mutex>& lock) {
  helped = helped && std::atoi(helpers_at_first.c_str()) != 0;
  const auto fits = [&] { return display == EGL_NO_DISPLAY || open_displays()[display].helped == helped; };
  context_gone.wait(lock, [&] { return fits() || open_displays()[display].contexts == 0; });
  if (fits()) return;
  eglTerminate(display);
  open_displays().erase(display);
  setenv("LP_NUM_THREADS", helped ? helpers_at_first.c_str() : "0", 1);
  initialize(display);
  setenv("LP_NUM_THREADS", "0", 1);
}

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
      const std::string extensions = text(eglQueryDeviceStringEXT(candidate.handle, EGL_EXTENSIONS));
      candidate.device.software = extensions.find("EGL_MESA_device_software") != std::string::npos;
      if (extensions.find("EGL_EXT_device_drm") != std::string::npos)
        candidate.device.node = text(eglQueryDeviceStringEXT(candidate.handle, EGL_DRM_DEVICE_FILE_EXT));
      found.push_back(candidate);
    }
  }
  if (found.empty()) {
    Candidate surfaceless;
    surfaceless.device.software = true;
    found.push_back(surfaceless);
  }
  return found;
}

EGLDisplay open_display(const Candidate& candidate) {
  if (!eglGetPlatformDisplayEXT) return EGL_NO_DISPLAY;
  const auto is = [&](HelperThreads threads) { return candidate.threads == threads; };
  // Mesa opens one display for an empty list of attributes and another one for no list.
  const EGLint nothing[] = {EGL_NONE};
  const EGLint* attributes = is(HelperThreads::none_too) || is(HelperThreads::sessions) ? nothing : nullptr;
  if (candidate.handle && (is(HelperThreads::none) || is(HelperThreads::none_too)))
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, candidate.handle, attributes);
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, attributes);
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

/// Makes a context on the device and makes it current; fills in the device's names or its problem.
Opened open(Candidate& candidate) {
  Device& device = candidate.device;
  Opened opened;
  opened.display = open_display(candidate);
  if (!initialize(opened.display)) {
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
  device.memory = memory_of(device);
  device.usable = true;
  return opened;
}

void close(const Opened& opened) {
  eglMakeCurrent(opened.display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(opened.display, opened.context);
}

/// Opens the same software device through the display of `threads`, because in Mesa each display has its own
/// helper threads. Empty if that display leads to another device.
std::optional<Opened> open_apart(Candidate candidate, HelperThreads threads, std::optional<bool> helped,
                                 std::unique_lock<std::mutex>& lock) {
  const std::string wanted = candidate.device.name;
  candidate.threads = threads;
  if (helped && !helpers_at_first.empty()) reopen(open_display(candidate), *helped, lock);
  const Opened opened = open(candidate);
  if (candidate.device.usable && candidate.device.name == wanted) return opened;
  if (candidate.device.usable) close(opened);
  return std::nullopt;
}

}  // namespace

void compute_without_helper_threads() {
  const std::lock_guard lock(egl_mutex);
  if (!helpers_at_first.empty() || !load_egl()) return;
  std::vector<Candidate> all = candidates();
  // Without devices there is one display for all.
  if (std::any_of(all.begin(), all.end(),
                  [](const Candidate& one) { return !one.device.software || !one.handle; }))
    return;
  for (Candidate& candidate : all)
    for (const HelperThreads threads : {HelperThreads::sessions, HelperThreads::lab}) {
      candidate.threads = threads;
      initialize(open_display(candidate));
    }
  helpers_at_first = wanted_helpers();
  setenv("LP_NUM_THREADS", "0", 1);
}

bool computes_on_calling_thread() {
  if (!software_renderer()) return false;
  const std::lock_guard lock(egl_mutex);
  const auto found = open_displays().find(eglGetCurrentDisplay());
  return found != open_displays().end() && !found->second.helped;
}

std::string renderer_name() {
  return gl_text(GL_RENDERER);
}

bool software_renderer() {
  const std::string name = renderer_name();
  for (const char* rasteriser : {"llvmpipe", "softpipe", "SWR"})
    if (name.find(rasteriser) != std::string::npos) return true;
  return false;
}

Result<std::vector<Device>> list_devices() {
  const std::lock_guard lock(egl_mutex);
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
  std::unique_lock lock(egl_mutex);
  if (Status loaded = load_egl(); !loaded) return loaded.error();
  std::vector<Candidate> all = candidates();
  const int count = static_cast<int>(all.size());
  if (gpu && (*gpu < 0 || *gpu >= count))
    return Error{"--gpu", std::to_string(*gpu),
                 "a device from 0 to " + std::to_string(count - 1) + "; `clothlab info` lists them"};

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
      ++open_displays()[opened.display].contexts;
      return context;
    }
  }
  return Error{"OpenGL", "no device offers OpenGL 4.5 core:" + problems, install_hint};
}

Context::~Context() {
  if (eglGetCurrentContext() == context_)
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  {
    const std::lock_guard lock(egl_mutex);
    --open_displays()[display_].contexts;
  }
  context_gone.notify_all();
}

bool Context::lost() const {
  return glGetGraphicsResetStatus() != GL_NO_ERROR;
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
