// The pieces of work that are queued on the GPU and not finished yet. Their number is bounded, and the time
// that each takes is measured.
#pragma once

#include <glad/gl.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace clothlab::session {

class GpuBacklog {
 public:
  using Time = std::chrono::steady_clock::time_point;

  GpuBacklog() = default;
  ~GpuBacklog();
  GpuBacklog(const GpuBacklog&) = delete;
  GpuBacklog& operator=(const GpuBacklog&) = delete;

  bool full() const { return count_ == queued_.size(); }
  bool empty() const { return count_ == 0; }
  struct Piece {
    std::uint32_t steps = 0;   ///< number of steps that end in this piece
    std::uint32_t places = 0;  ///< number of places at which the piece might have stopped (sim::Pace)
    Time begun{};              ///< when the queueing began
  };
  /// Adds a piece that has just been queued. The backlog must not be full.
  void push(const Piece& piece);
  /// Calls `spent(piece, seconds)` for each piece that has finished by `now`, with the time since the piece
  /// before it ended, or since it was begun if that is later [s]. Never waits.
  template <class Spent>
  void poll(Time now, Spent spent) {
    while (finished()) {
      const Piece& piece = queued_[first_].piece;
      const Time begun = piece.begun > last_end_ ? piece.begun : last_end_;
      spent(piece, std::chrono::duration<double>(now - begun).count());
      last_end_ = now;
      pop();
    }
  }

 private:
  bool finished();
  void pop();

  struct Queued {
    GLsync fence = nullptr;
    Piece piece;
  };
  std::array<Queued, 3> queued_{};
  std::size_t first_ = 0, count_ = 0;
  Time last_end_{};
};

}  // namespace clothlab::session
