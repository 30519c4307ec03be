// States that a session keeps to go back to: copies of all that the next step depends on, with what the
// passes remember of earlier steps. So the same steps follow from a copy as from the state itself, bit for
// bit, and keeping one changes nothing.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "server/scene/keys.h"
#include "server/scene/scene.h"
#include "server/sim/carried.h"
#include "server/sim/state.h"

namespace clothlab::sim {

struct KeptState {
  gl::Buffer position, velocity;
  Carried carried{};
  std::uint64_t step = 0;
  double time = 0;        ///< [s]
  double start_time = 0;  ///< of Simulation::Implementation, as the next
  std::uint64_t start_step = 0;
  std::vector<scene::Motion> settled{};  ///< likewise
  std::vector<scene::KeyedScene::LetGo> released{};
  std::uint32_t neighbour_slots = 0;  ///< of Plan

  std::size_t bytes() const { return position.bytes() + velocity.bytes() + carried.bytes(); }
};

/// The oldest are dropped beyond `most_states` and `most` bytes. A single one is kept, however large. Those
/// that are set aside, of a run that was left, count, and are dropped first.
class KeptStates {
 public:
  static constexpr std::size_t most_states = 256;

  std::size_t most = 32 * 1024 * 1024;  ///< [bytes]
  std::uint32_t every = 0;              ///< a state is kept at each multiple of so many steps; 0: at none
  bool after_step = false;              ///< one is kept at the end of the next step, too
  bool due(std::uint64_t step) const { return after_step || (every > 0 && step % every == 0); }

  /// Keeps a state that `copy` fills. It may have buffers already, those of the oldest state, to be used
  /// again.
  void keep(const std::function<void(KeptState&)>& copy);
  /// The newest state at or before `step`; null: there is none.
  const KeptState* at_or_before(std::uint64_t step) const;
  const KeptState* oldest() const { return states_.empty() ? nullptr : &states_.front(); }
  std::size_t count() const { return states_.size(); }
  std::size_t bytes() const;
  void drop_oldest() { states_.pop_front(); }
  void drop_after(std::uint64_t step);
  void clear() {
    states_.clear();
    drop_aside();
  }

  /// Exchanges the states after `step` for those that are set aside.
  void exchange_aside(std::uint64_t step);
  void drop_aside() {
    aside_.clear();
    lost_aside_ = false;
  }
  /// True if those set aside had to make room, all of them: the run that was left is a long way back.
  bool lost_aside() const { return lost_aside_; }

 private:
  bool lacks_place(std::size_t expected) const;

  std::deque<KeptState> states_;  ///< the oldest first
  std::deque<KeptState> aside_;   ///< likewise
  bool lost_aside_ = false;
};

}  // namespace clothlab::sim
