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

/// Software OpenGL computes on threads of its own, which contexts of a device share: they work in turns, at
/// the priority of whoever made the first one.
enum class HelperThreads {
  shared,
  /// Made by, and with the priority of, the thread that first makes a context of this kind; where that cannot
  /// be: shared.
  own,
  own_too  ///< the same, apart from those as well
};

/// A context that belongs to the thread that made it current. Order of devices: `gpu` if given; else the
/// first usable one that is not software; else Mesa's software rasteriser.
class Context {
 public:
  /// Makes a context and makes it current on the calling thread. Error: what is missing and the package to
  /// install.
  static Result<std::unique_ptr<Context>> create(std::optional<int> gpu = std::nullopt,
                                                 HelperThreads threads = HelperThreads::shared);
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
