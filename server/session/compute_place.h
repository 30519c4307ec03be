// Where a session's scene is computed on software OpenGL. Mesa computes for all contexts of one display one
// after another, and has few displays. Scenes that one core surely steps in real time are spread over two
// displays whose contexts compute on the sessions' own threads. Heavier scenes share the helper threads of a
// third, which have a lower priority.
#pragma once

#include "server/gl/context.h"
#include "server/scene/scene.h"

namespace clothlab::session {

/// A claim to a part of a display's time, given up at the end of its life.
class ComputePlace {
 public:
  /// For a scene that is to run in real time. Of the displays without helper threads it takes the one of
  /// which least is claimed.
  static ComputePlace claim(const scene::Scene& scene);
  ComputePlace(ComputePlace&& other) noexcept;
  ComputePlace& operator=(ComputePlace&& other) noexcept;
  ~ComputePlace();

  /// True if a changed scene may stay here, as it does near the boundary; then it claims as much as it takes.
  bool stays(const scene::Scene& scene);

  gl::HelperThreads threads() const { return threads_; }

 private:
  ComputePlace(gl::HelperThreads threads, double share);
  gl::HelperThreads threads_;
  double share_;  ///< of one core
};

}  // namespace clothlab::session
