// Batches of steps queued on the GPU and not finished yet: their number is bounded, and what they took is
// measured.
#pragma once

#include <glad/gl.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace clothlab::net {

class GpuBacklog {
 public:
  using Time = std::chrono::steady_clock::time_point;

  GpuBacklog() = default;
  ~GpuBacklog();
  GpuBacklog(const GpuBacklog&) = delete;
  GpuBacklog& operator=(const GpuBacklog&) = delete;

  bool full() const { return count_ == batches_.size(); }
  bool empty() const { return count_ == 0; }
  /// A batch has been queued, the work for it begun at `begun`. The backlog must not be full.
  void push(std::uint32_t steps, Time begun);
  /// Calls `spent(steps, seconds)` for each batch that has finished by `now`. Never waits.
  template <class Spent>
  void poll(Time now, Spent spent) {
    while (finished()) {
      const Batch& batch = batches_[first_];
      const Time begun = batch.begun > last_end_ ? batch.begun : last_end_;
      spent(batch.steps, std::chrono::duration<double>(now - begun).count());
      last_end_ = now;
      pop();
    }
  }

 private:
  bool finished();
  void pop();

  struct Batch {
    GLsync fence = nullptr;
    std::uint32_t steps = 0;
    Time begun;
  };
  std::array<Batch, 3> batches_{};
  std::size_t first_ = 0, count_ = 0;
  Time last_end_{};
};

}  // namespace clothlab::net
