// A headless OpenGL 4.5 core context through surfaceless EGL.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/gl/software/software.h"

namespace clothlab::gl {

struct Device {
  int index = 0;          ///< the N of `--gpu N`
  std::string name;       ///< GL_RENDERER; empty if no context could be made
  std::string version;    ///< GL_VERSION
  std::string vendor;     ///< GL_VENDOR
  std::string node;       ///< device file /dev/dri/..., or empty
  bool software = false;  ///< it is Mesa's software rasteriser
  /// Its memory [bytes], the machine's where that computes; 0 if the driver does not tell.
  std::uint64_t memory = 0;
  bool usable = false;  ///< OpenGL 4.5 core works on this device
  std::string problem;  ///< why it is not usable
};

/// GL_RENDERER of the calling thread's current context.
std::string renderer_name();

/// Every EGL device in the driver's order; opens a context on each to ask its name.
Result<std::vector<Device>> list_devices();

/// A context that belongs to the thread that made it current. Its device is `gpu` if given; else the first
/// usable device that is not software; else Mesa's software rasteriser.
class Context {
 public:
  /// Makes a context and makes it current on the calling thread. `threads` has no effect on a GPU; if Mesa
  /// cannot open another display, that of `none` is used. `helped`: the display of `threads` is to compute
  /// with, or without, helper threads; for that it may have to be opened anew, which waits until no other
  /// context of it exists. Error: what is missing and the package to install.
  static Result<std::unique_ptr<Context>> create(std::optional<int> gpu = std::nullopt,
                                                 HelperThreads threads = HelperThreads::none,
                                                 std::optional<bool> helped = std::nullopt);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  const Device& device() const { return device_; }
  /// True from a reset of the device on: its data are lost, and nothing of this context works any more. The
  /// context must be current on the calling thread.
  bool lost() const;
  /// Moves the context to the calling thread (it must be current on no other).
  Status make_current();
  void release_current();

 private:
  Context() = default;
  Device device_;
  void* display_ = nullptr;
  void* context_ = nullptr;
  mutable bool lost_ = false;  ///< OpenGL tells of a reset until the device is back, and no longer
};

}  // namespace clothlab::gl
