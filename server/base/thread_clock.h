// The processor time of the calling thread: how much work it has done, however busy the machine is.
#pragma once

#include <chrono>

namespace clothlab {

struct ThreadClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<ThreadClock>;
  static constexpr bool is_steady = true;

  /// Times of one thread can be compared with each other alone.
  static time_point now();
};

}  // namespace clothlab
