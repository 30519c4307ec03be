// A headless OpenGL 4.5 core context through surfaceless EGL. Knows no cloth.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::gl {

struct Device {
  int index = 0;          ///< the N of `--gpu N`
  std::string name;       ///< GL_RENDERER, empty where no context could be made
  std::string version;    ///< GL_VERSION
  std::string vendor;     ///< GL_VENDOR
  std::string node;       ///< /dev/dri/... or empty
  bool software = false;  ///< Mesa's rasteriser
  bool usable = false;    ///< OpenGL 4.5 core works on it
  std::string problem;    ///< why not usable
};

/// Mesa's rasteriser draws in the context that is current here.
bool software_renderer();

/// GL_RENDERER of the context that is current here.
std::string renderer_name();

/// Every EGL device in the driver's order; opens a context on each to ask its name.
Result<std::vector<Device>> list_devices();

/// Software OpenGL computes on helper threads, which all contexts of one display share: they work in turns,
/// one dispatch after another, however long, at the priority of whoever made the first context there. Mesa
/// tells as many displays of its software device apart as there are names here; who shares each:
enum class HelperThreads { light_sessions, heavy_sessions, lab, pictures };

/// A context that belongs to the thread that made it current. Order of devices: `gpu` if given; else the
/// first usable one that is not software; else Mesa's software rasteriser.
class Context {
 public:
  /// Makes a context and makes it current on the calling thread. `threads` means nothing to a GPU, and where
  /// Mesa has no further display they are those of light sessions. Error: what is missing and the package to
  /// install.
  static Result<std::unique_ptr<Context>> create(std::optional<int> gpu = std::nullopt,
                                                 HelperThreads threads = HelperThreads::light_sessions);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Device& device() const { return device_; }
  /// Whether the device was reset, and all that was on it is gone: nothing of this context works any more.
  /// The context must be current here.
  bool lost() const;
  /// Moves the context to the calling thread (it must be current on no other).
  Status make_current();
  void release_current();

 private:
  Context() = default;
  Device device_;
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace clothlab::gl
