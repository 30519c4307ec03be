// Poses of everything that moves, for each step of a batch: computed in double precision, read by
// shaders/methods/motions.glsl.
#pragma once

#include <cstdint>
#include <vector>

#include "server/gl/buffer.h"
#include "server/scene/scene.h"

namespace clothlab::sim {

/// Most steps that are queued behind one upload of the table.
inline constexpr std::uint32_t batch_steps = 32;

class MotionTable {
 public:
  MotionTable() = default;
  /// Each step has `rows_a_step` rows after the one at its start.
  MotionTable(std::vector<scene::Motion> motions, int rows_a_step);

  bool empty() const { return motions_.empty(); }
  /// The index kernels use, or -1 for a motion that is null.
  int index(const scene::Motion& motion) const;

  /// Uploads the poses at `times` [s]: a row for the start of the batch and rows_a_step for each step.
  void upload(const std::vector<double>& times);
  void bind(GLuint unit) const { table_.bind(unit); }

 private:
  std::vector<scene::Motion> motions_;
  std::vector<float> rows_;
  gl::TextureBuffer table_;
};

}  // namespace clothlab::sim
