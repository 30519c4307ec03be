// A turn to compute on one of the displays that sessions share on software OpenGL. Without turns Mesa lets
// the contexts of a display alternate at every dispatch, and each finds its code and its cloth gone from the
// processor's caches.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/gl/context.h"

namespace clothlab::session {

/// Turns go round in the order in which they are asked for. One that takes long ends early if others wait,
/// and its holder computes on beside them.
class [[nodiscard]] DisplayTurn {
 public:
  /// Waits until it is this one's turn.
  explicit DisplayTurn(gl::HelperThreads display);
  ~DisplayTurn();
  DisplayTurn(const DisplayTurn&) = delete;
  DisplayTurn& operator=(const DisplayTurn&) = delete;

  /// Number of turns that wait for the display now.
  static std::size_t waiting(gl::HelperThreads display);
  /// Number of others that waited when it began.
  std::uint32_t others() const { return others_; }

 private:
  gl::HelperThreads display_;
  std::uint32_t others_ = 0;
};

}  // namespace clothlab::session
