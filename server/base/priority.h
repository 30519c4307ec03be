// The priority of a thread on a busy machine.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

namespace clothlab {

/// Sets the calling thread's priority to `nice`, from 0 (normal) to 19 (lowest). On Linux each thread has its
/// own priority, and a new thread inherits that of the thread that made it. A failure is ignored: it only
/// makes the sessions slower.
inline void lower_priority(int nice) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), nice);
}

}  // namespace clothlab
