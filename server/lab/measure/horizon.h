// Until when motions can be compared vertex by vertex: as long as a copy that starts a little away stays
// near.
#pragma once

#include <string>

#include "server/reference/reference.h"

namespace clothlab::lab {

/// The number of times, evenly spread over a run, at which the two are compared.
inline constexpr int looks_for_horizon = 128;

class Horizon {
 public:
  /// `size`: the cloth's [m]. The copy's free vertices are moved in random directions, the same in every run.
  Horizon(const reference::World& world, double size);

  /// The copy, which whoever follows the motion follows, too.
  reference::State& copy() { return copy_; }

  /// Compares at time `time` [s]. False: they are too far apart, now or earlier.
  bool look(const reference::State& motion, double time);

  /// For a motion that was followed until `whole` [s]: the time until which it can be compared [s], 0 where
  /// that is too short for anything.
  double time(double whole) const;
  /// How it was found, a sentence.
  std::string reason(double whole) const;

 private:
  reference::State copy_;
  double begun_, time_ = 0, most_ = 1, amplified_ = 1;
};

}  // namespace clothlab::lab
