// Computes energies, strain, speed and contacts of the whole state: a reduction on the GPU
// (shaders/diagnose.comp). Its partial results come back through a ring of buffers; the host waits for them
// only if asked to.
#pragma once

#include <array>
#include <deque>

#include "server/gl/program.h"
#include "server/sim/self_collision.h"
#include "server/sim/simulation.h"
#include "server/sim/state.h"
#include "server/sim/surface_contact.h"

namespace clothlab::sim {

class DiagnosticsPass {
 public:
  static Result<DiagnosticsPass> create(std::uint32_t vertex_count);

  /// Queues the reduction; waits for the oldest if too many are still on their way. The element lists and
  /// their slices must be bound. `self_collision` and `surfaces` may be null.
  void request(const StateBuffers& state, const SelfCollision* self_collision, const SurfaceContact* surfaces,
               const glm::dvec3& gravity, double time, std::uint64_t step);
  /// Stores the oldest result in `out` and returns true if it has arrived; with `wait`, waits for it. Returns
  /// false if no result is there.
  bool poll(Diagnostics& out, bool wait);

 private:
  void take(Diagnostics& out);

  gl::Program program_;
  gl::Buffer results_;  ///< the partial results, then the counters of self-collision and of surfaces
  gl::ReadbackRing ring_;
  /// What is known of a result on its way; without a kind of self-collision its counters mean nothing.
  struct Pending {
    double time = 0;
    std::uint64_t step = 0;
    bool self_collision = false, surfaces = false;
  };
  static constexpr std::size_t ring_slots = 3;
  std::array<Pending, ring_slots> pending_{};
  std::size_t requested_ = 0, delivered_ = 0;
  std::deque<Diagnostics> arrived_;  ///< out of a ring that was full
  std::uint32_t groups_ = 0;
};

}  // namespace clothlab::sim
