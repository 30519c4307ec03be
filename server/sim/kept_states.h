// States that a session keeps to go back to: copies on the GPU of all that the next step depends on, once the
// passes have forgotten what they carry from step to step. So the same steps follow from a copy, bit for bit.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "server/scene/scene.h"
#include "server/sim/state.h"

namespace clothlab::sim {

struct KeptState {
  gl::Buffer position, velocity;
  std::uint64_t step = 0;
  double time = 0;        ///< [s]
  double start_time = 0;  ///< of Simulation::Implementation, as the next
  std::uint64_t start_step = 0;
  std::vector<scene::Motion> settled{};  ///< likewise
  std::uint32_t neighbour_slots = 0;     ///< of Plan
};

/// The oldest are dropped beyond `most_states` and `most_bytes`. A single one is kept, however large.
class KeptStates {
 public:
  static constexpr std::size_t most_states = 256;
  static constexpr std::size_t most_bytes = 32 * 1024 * 1024;

  std::uint32_t every = 0;  ///< a state is kept at each multiple of so many steps; 0: at none
  bool due(std::uint64_t step) const { return every > 0 && step % every == 0; }

  /// Copies the shown state. `when` has all but the copies.
  void keep(const StateBuffers& state, std::uint32_t vertex_count, KeptState when);
  /// The newest state at or before `step`; null: there is none.
  const KeptState* at_or_before(std::uint64_t step) const;
  const KeptState* oldest() const { return states_.empty() ? nullptr : &states_.front(); }
  std::size_t count() const { return states_.size(); }
  std::size_t bytes() const;
  void drop_oldest() { states_.pop_front(); }
  void drop_after(std::uint64_t step);
  void clear() { states_.clear(); }

 private:
  std::deque<KeptState> states_;  ///< the oldest first
};

}  // namespace clothlab::sim
