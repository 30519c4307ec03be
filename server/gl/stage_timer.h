// Measures how long the stages of queued GPU work take, without waiting for the GPU: it queues timestamps
// (GL_TIMESTAMP) between them.
#pragma once

#include <glad/gl.h>

#include <array>
#include <cstddef>

namespace clothlab::gl {

struct StageTime {
  const char* stage = "";
  double seconds = 0;  ///< GPU time since the end of the stage before [s]
};

/// A list of at most 8 stage times, without an allocation; further times are left out.
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

  /// Starts to time what is queued until `end`. Does nothing while earlier times wait for `poll`.
  void begin();
  /// Ends the stage `name` (a string literal): what has been queued since `begin` or the stage before. Does
  /// nothing unless `begin` has started to time.
  void stage(const char* name);
  void end();
  /// Appends the times of the stages between the last `begin` and `end`, once they have arrived. Never waits.
  void poll(StageTimes& out);

 private:
  enum class State { idle, running, waiting };
  State state_ = State::idle;
  std::array<GLuint, most_stages + 1> marks_{};  ///< timestamp queries, made when first needed
  std::array<const char*, most_stages> names_{};
  std::size_t stages_ = 0;
};

}  // namespace clothlab::gl
