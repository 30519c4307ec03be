/* Preloaded into a server: the wall clock (CLOCK_REALTIME) jumps an hour ahead 2 s after the start, and two hours back
   1 s later. Other clocks are as they are. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sys/time.h>
#include <time.h>

typedef int Read(clockid_t, struct timespec*);

static long jump(Read* read) {
  static time_t start = 0;
  struct timespec now;
  read(CLOCK_MONOTONIC, &now);
  if (start == 0) start = now.tv_sec;
  const time_t since = now.tv_sec - start;
  return since < 2 ? 0 : since < 3 ? 3600 : -3600;
}

int clock_gettime(clockid_t which, struct timespec* out) {
  static Read* read = 0;
  if (!read) read = (Read*)dlsym(RTLD_NEXT, "clock_gettime");
  const int result = read(which, out);
  if (result == 0 && which == CLOCK_REALTIME) out->tv_sec += jump(read);
  return result;
}

int gettimeofday(struct timeval* restrict out, void* restrict zone) {
  (void)zone;
  struct timespec now;
  const int result = clock_gettime(CLOCK_REALTIME, &now);
  out->tv_sec = now.tv_sec;
  out->tv_usec = now.tv_nsec / 1000;
  return result;
}

time_t time(time_t* out) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (out) *out = now.tv_sec;
  return now.tv_sec;
}
