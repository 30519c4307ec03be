#include "server/base/memory.h"

#include <cstdlib>  // __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace clothlab {

#ifdef __GLIBC__
void share_free_memory() {
  mallopt(M_ARENA_MAX, 2);
}
void release_free_memory() {
  malloc_trim(0);
}
#else
void share_free_memory() {}
void release_free_memory() {}
#endif

}  // namespace clothlab
