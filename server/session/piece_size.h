// How large a piece of a step may be: a share of a turn, in milliseconds as measured, so that a session that
// steps a heavy scene still hears what is asked of it, and no driver's watchdog takes it for hung.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "server/sim/work.h"

namespace clothlab::session {

/// Where queueing returns before the work is done, as on a GPU, the clock alone would not end a piece in
/// time: then what earlier pieces took says how many dispatches fit.
class PieceSize {
 public:
  static constexpr double budget = 0.010;  ///< [s]

  sim::Pace pace(sim::Pace::Clock::time_point now) const {
    using namespace std::chrono;
    return {now + duration_cast<sim::Pace::Clock::duration>(duration<double>(budget)), most_};
  }

  /// A piece with so many places to stop took so long [s].
  void measured(std::uint32_t places, double seconds) {
    if (seconds > 2 * budget && places > 0)
      most_ = std::max(1u, static_cast<std::uint32_t>(std::min(places, most_) * budget / seconds));
    else if (seconds < 0.5 * budget && places >= most_)
      most_ = std::min(most_, largest / 2) * 2;
  }

 private:
  static constexpr std::uint32_t largest = 1u << 20;
  std::uint32_t most_ = 256;
};

}  // namespace clothlab::session
