// How much of a busy machine a thread may have.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace clothlab {

/// Makes the calling thread give way: `nice` from 0 to 19, the lowest. Linux counts priorities by thread, and
/// threads that a thread makes inherit its own. A failure costs the sessions some speed and the caller
/// nothing.
inline void lower_priority(int nice) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice);
}

}  // namespace clothlab
