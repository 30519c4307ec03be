// Keeps a process that runs for months from holding more memory than it needs. By default, glibc keeps the
// memory that a thread has freed for that thread (malloc(3), arenas), but sessions' threads come and go.
#pragma once

namespace clothlab {

/// Limits malloc to two arenas, so that all threads reuse what one thread has freed. Call it before the
/// process starts a second thread.
void share_free_memory();

/// Returns free memory to the system (malloc_trim(3)). Takes some milliseconds: call it on a thread that has
/// no other work to do in that time.
void release_free_memory();

}  // namespace clothlab
