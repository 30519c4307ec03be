#include "server/sim/motion_table.h"

#include <algorithm>

#include "server/model/motion.h"
#include "server/scene/keys.h"

namespace clothlab::sim {

namespace {
constexpr std::size_t floats_a_pose = 20, floats_a_wind = 4;
}

MotionTable::MotionTable(std::vector<scene::Motion> motions, std::optional<scene::Wind> wind, int rows_a_step,
                         std::vector<scene::Key> keys)
    : motions_(std::move(motions)), settled_(motions_.size(), false), wind_(wind), keys_(std::move(keys)) {
  if (empty()) return;
  const std::size_t rows = batch_steps * static_cast<std::size_t>(rows_a_step) + 1;
  rows_.resize(rows * (motions_.size() * floats_a_pose + (wind_ ? floats_a_wind : 0)));
  table_ = gl::TextureBuffer(gl::Buffer(rows_.size() * sizeof(float)), GL_RGBA32F);
}

int MotionTable::index(const scene::Motion& motion) const {
  const auto found = std::find(motions_.begin(), motions_.end(), motion);
  return found == motions_.end() ? -1 : static_cast<int>(found - motions_.begin());
}

void MotionTable::settle(const std::vector<scene::Motion>& settled) {
  for (std::size_t i = 0; i < motions_.size(); ++i)
    settled_[i] = std::find(settled.begin(), settled.end(), motions_[i]) != settled.end();
}

void MotionTable::upload(const std::vector<double>& times) {
  float* out = rows_.data();
  const auto write = [&out](const glm::dvec3& xyz, double w) {
    for (int axis = 0; axis < 3; ++axis) *out++ = static_cast<float>(xyz[axis]);
    *out++ = static_cast<float>(w);
  };
  for (const double time : times) {
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const model::Pose pose = model::pose(motions_[i], time, settled_[i]);
      for (int row = 0; row < 3; ++row)
        write({pose.rotation[0][row], pose.rotation[1][row], pose.rotation[2][row]}, pose.translation[row]);
      write(pose.linear_velocity, 0.0);
      write(pose.angular_velocity, 0.0);
    }
    if (wind_) write(model::wind_velocity(scene::wind_at(*wind_, keys_, time), time), 0.0);
  }
  table_.buffer.upload(rows_.data(), static_cast<std::size_t>(out - rows_.data()) * sizeof(float));
}

}  // namespace clothlab::sim
