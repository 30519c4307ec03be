// The poses of moving pins and colliders, and the wind, for each step of a batch: computed in double
// precision, read by shaders/methods/motions.glsl.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/gl/buffer.h"
#include "server/scene/scene.h"

namespace clothlab::sim {

/// Largest number of steps in a batch. The table is uploaded once for each batch.
inline constexpr std::uint32_t batch_steps = 32;

class MotionTable {
 public:
  MotionTable() = default;
  /// `rows_a_step`: number of rows of each step after the row of its start (Plan::pose_rows). `keys`:
  /// among them those of the wind.
  MotionTable(std::vector<scene::Motion> motions, std::optional<scene::Wind> wind, int rows_a_step,
              std::vector<scene::Key> keys = {});

  bool empty() const { return motions_.empty() && !wind_; }
  /// The index under which kernels find `motion` in the table; -1 for a null motion.
  int index(const scene::Motion& motion) const;

  /// Pins that were added to the running cloth are at their places, and do not glide there (scene::Placed).
  void settle(const std::vector<scene::Motion>& settled);

  /// Uploads the poses and the wind at `times` [s], one row each: the start of the batch, then rows_a_step
  /// rows for each step.
  void upload(const std::vector<double>& times);
  void bind(GLuint unit) const { table_.bind(unit); }

 private:
  std::vector<scene::Motion> motions_;
  std::vector<bool> settled_;  ///< for each of them
  std::optional<scene::Wind> wind_;
  std::vector<scene::Key> keys_;
  std::vector<float> rows_;
  gl::TextureBuffer table_;
};

}  // namespace clothlab::sim
