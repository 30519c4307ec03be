// How a process that runs for months keeps no more memory than it needs: glibc by itself keeps what each
// thread has freed for that thread (malloc(3), arenas), and the threads of sessions come and go.
#pragma once

namespace clothlab {

/// What one thread frees is any thread's to use. Before the first other thread.
void share_free_memory();

/// Gives back to the system what is free (malloc_trim(3)): some milliseconds, on a thread that has them.
void release_free_memory();

}  // namespace clothlab
