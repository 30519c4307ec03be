// How long stages of queued GPU work take, found out without waiting: timestamps between them (GL_TIMESTAMP).
#pragma once

#include <glad/gl.h>

#include <array>
#include <cstddef>

namespace clothlab::gl {

struct StageTime {
  const char* stage = "";
  double seconds = 0;  ///< on the GPU, from the end of the stage before
};

/// Some of them, without an allocation; those beyond its room are left out.
class StageTimes {
 public:
  void add(const StageTime& time) {
    if (size_ < times_.size()) times_[size_++] = time;
  }
  std::size_t size() const { return size_; }
  const StageTime& operator[](std::size_t i) const { return times_[i]; }
  const StageTime* begin() const { return times_.data(); }
  const StageTime* end() const { return times_.data() + size_; }

 private:
  std::array<StageTime, 8> times_{};
  std::size_t size_ = 0;
};

class StageTimer {
 public:
  static constexpr std::size_t most_stages = 4;

  StageTimer() = default;
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

  /// What is queued from here to `end` is timed, unless the times of the last time are still on their way.
  void begin();
  /// What has been queued since `begin` or the last stage was this one: a literal. Nothing unless begun.
  void stage(const char* name);
  void end();
  /// Adds the times of the stages between the last `begin` and `end`, once they have arrived. Never waits.
  void poll(StageTimes& out);

 private:
  enum class State { idle, running, waiting };
  State state_ = State::idle;
  std::array<GLuint, most_stages + 1> marks_{};  ///< queries; made when first needed
  std::array<const char*, most_stages> names_{};
  std::size_t stages_ = 0;
};

}  // namespace clothlab::gl
