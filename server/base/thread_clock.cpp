#include "server/base/thread_clock.h"

#include <ctime>

namespace clothlab {

ThreadClock::time_point ThreadClock::now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time_point(std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec));
}

}  // namespace clothlab
