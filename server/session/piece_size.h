// How large a piece of a step may be. Its measured time is limited, so that a session that steps a heavy
// scene still handles commands, and the driver's watchdog does not take the GPU for hung.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "server/sim/work.h"

namespace clothlab::session {

/// The clock alone cannot end a piece in time where queueing returns before the work is done, as on a GPU.
/// There the times of earlier pieces say how many dispatches fit.
class PieceSize {
 public:
  static constexpr double budget = 0.010;    ///< the time a piece may take [s]
  static constexpr double shortest = 0.004;  ///< the same while others wait [s]

  /// `others`: number of sessions that wait for this piece to end. Pieces are shorter then, so that these
  /// wait less, but not so short that most of a piece goes by until its data is in the processor's caches.
  sim::Pace pace(sim::Pace::Clock::time_point now, std::uint32_t others) const {
    using namespace std::chrono;
    const duration<double> most(std::max(budget / (1 + others), shortest));
    return {now + duration_cast<sim::Pace::Clock::duration>(most), most_places_};
  }

  /// Takes in that a piece with `places` places to stop took `seconds` [s].
  void add_piece_time(std::uint32_t places, double seconds) {
    if (seconds > 2 * budget && places > 0)
      most_places_ =
          std::max(1u, static_cast<std::uint32_t>(std::min(places, most_places_) * budget / seconds));
    else if (seconds < 0.5 * budget && places >= most_places_)
      most_places_ = std::min(most_places_, largest / 2) * 2;
  }

 private:
  static constexpr std::uint32_t largest = 1u << 20;
  std::uint32_t most_places_ = 256;  ///< places to stop that a piece may pass
};

}  // namespace clothlab::session
