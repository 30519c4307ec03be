// Energies, strain, speed and contacts of the whole state: a reduction on the GPU
// (shaders/diagnose.comp) whose partial results come back through a ring, without waiting unless asked
// to.
#pragma once

#include <array>

#include "server/gl/program.h"
#include "server/sim/self_collision.h"
#include "server/sim/simulation.h"
#include "server/sim/state.h"

namespace clothlab::sim {

class DiagnosticsPass {
 public:
  static Result<DiagnosticsPass> create(std::uint32_t vertex_count);

  /// Queues the reduction. False if too many are still on their way. Springs and slices must be bound.
  /// `self_collision` may be null.
  bool request(const StateBuffers& state, const SelfCollision* self_collision, const glm::dvec3& gravity,
               double time, std::uint64_t step);
  /// True and the oldest result, if one has arrived or `wait` is set and one was requested.
  bool poll(Diagnostics& out, bool wait);

 private:
  gl::Program program_;
  gl::Buffer results_;  ///< the partial results, then self-collision's counters
  gl::ReadbackRing ring_;
  static constexpr std::size_t ring_slots = 3;
  std::array<std::pair<double, std::uint64_t>, ring_slots>
      shown_{};  ///< time and step of each result on its way
  std::size_t requested_ = 0, delivered_ = 0;
  std::uint32_t groups_ = 0;
};

}  // namespace clothlab::sim
