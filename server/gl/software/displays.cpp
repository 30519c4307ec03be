#include "server/gl/software/displays.h"

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/gl/devices.h"

namespace clothlab::gl {

namespace software {

namespace {

struct OpenDisplay {
  bool helped = false;  ///< software OpenGL computes on helper threads for it
  int contexts = 0;     ///< that exist
};
/// The displays that are open.
std::map<EGLDisplay, OpenDisplay>& open_displays() {
  static std::map<EGLDisplay, OpenDisplay> displays;
  return displays;
}
/// Notified when a context has gone.
std::condition_variable one_gone;

/// The number of helper threads that the environment asks for, by default one for each core; on a single core
/// there are none.
std::string wanted_helpers() {
  const char* number = std::getenv("LP_NUM_THREADS");
  const unsigned cores = std::thread::hardware_concurrency();
  return number ? number : std::to_string(cores > 1 ? cores : 0);
}
/// The same as the program began; set by `compute_without_helper_threads`.
std::string helpers_at_first;

/// By `gpu` of Context::create.
std::map<std::optional<int>, bool>& known_devices() {
  static std::map<std::optional<int>, bool> known;
  return known;
}

void initialize(EGLDisplay display) {
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) opened(display);
}

}  // namespace

bool plays_gpu() {
  static const char* asked = std::getenv("CLOTHLAB_PLAY_GPU");
  return asked && std::string_view(asked) == "1";
}

void check_software(const char* what) {
  if (!plays_gpu()) return;
  std::fprintf(stderr, "CLOTHLAB_PLAY_GPU: a GPU is asked for %s, which only software OpenGL has\n", what);
  std::abort();
}

EGLDisplay display_of(EGLDeviceEXT device, HelperThreads threads) {
  check_software("a display of its own");
  if (!eglGetPlatformDisplayEXT) return EGL_NO_DISPLAY;
  const auto is = [&](HelperThreads one) { return threads == one; };
  // Mesa opens one display for an empty list of attributes and another one for no list.
  const EGLint nothing[] = {EGL_NONE};
  const EGLint* attributes = is(HelperThreads::none_too) || is(HelperThreads::sessions) ? nothing : nullptr;
  if (device && (is(HelperThreads::none) || is(HelperThreads::none_too)))
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, attributes);
  return eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, attributes);
}

void opened(EGLDisplay display) {
  check_software("its helper threads");
  open_displays().emplace(display, OpenDisplay{std::atoi(wanted_helpers().c_str()) != 0, 0});
}

void reopen(EGLDisplay display, bool helped, std::unique_lock<std::mutex>& lock) {
  if (helpers_at_first.empty()) return;
  helped = helped && std::atoi(helpers_at_first.c_str()) != 0;
  const auto fits = [&] { return display == EGL_NO_DISPLAY || open_displays()[display].helped == helped; };
  one_gone.wait(lock, [&] { return fits() || open_displays()[display].contexts == 0; });
  if (fits()) return;
  eglTerminate(display);
  open_displays().erase(display);
  setenv("LP_NUM_THREADS", helped ? helpers_at_first.c_str() : "0", 1);
  initialize(display);
  setenv("LP_NUM_THREADS", "0", 1);
}

void context_made(EGLDisplay display) {
  ++open_displays()[display].contexts;
}

void context_gone(EGLDisplay display) {
  --open_displays()[display].contexts;
  one_gone.notify_all();
}

void note_device(std::optional<int> gpu, bool is_software) {
  known_devices()[gpu] = is_software;
}

}  // namespace software

void compute_without_helper_threads() {
  const std::lock_guard lock(egl_mutex());
  if (!software::helpers_at_first.empty() || !load_egl()) return;
  const std::vector<Candidate> all = candidates();
  // Without devices there is one display for all.
  if (std::any_of(all.begin(), all.end(),
                  [](const Candidate& one) { return !one.device.software || !one.handle; }))
    return;
  for (const Candidate& candidate : all)
    for (const HelperThreads threads : {HelperThreads::sessions, HelperThreads::lab})
      software::initialize(software::display_of(candidate.handle, threads));
  software::helpers_at_first = software::wanted_helpers();
  setenv("LP_NUM_THREADS", "0", 1);
}

bool computes_on_calling_thread() {
  if (!software_renderer()) return false;
  const std::lock_guard lock(egl_mutex());
  const auto found = software::open_displays().find(eglGetCurrentDisplay());
  return found != software::open_displays().end() && !found->second.helped;
}

bool software_renderer() {
  if (software::plays_gpu()) return false;
  const std::string name = renderer_name();
  for (const char* rasteriser : {"llvmpipe", "softpipe", "SWR"})
    if (name.find(rasteriser) != std::string::npos) return true;
  return false;
}

bool software_device(std::optional<int> gpu) {
  const auto known = [&] {
    const std::lock_guard lock(egl_mutex());
    const auto found = software::known_devices().find(gpu);
    return found == software::known_devices().end() ? std::nullopt : std::optional(found->second);
  };
  if (!known()) (void)Context::create(gpu);
  return known().value_or(false);
}

}  // namespace clothlab::gl
