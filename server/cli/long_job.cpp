#include "server/cli/long_job.h"

#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace clothlab::cli {

StopOnInterrupt::StopOnInterrupt() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  thread_ = std::thread([this] { wait(); });
}

StopOnInterrupt::~StopOnInterrupt() {
  done_ = true;
  thread_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void StopOnInterrupt::wait() {
  const timespec poll_interval{0, 50'000'000};
  while (!done_) {
    if (sigtimedwait(&signals_, nullptr, &poll_interval) < 0) continue;
    stop_.request_stop();
    pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);  // this thread's: the next signal ends the program
    while (!done_) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

ProgressLine::ProgressLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(const lab::Progress& progress) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || (shown_ && now - last_ < std::chrono::milliseconds(100))) return;
  last_ = now;
  shown_ = true;
  const double share = progress.total > 0 ? std::clamp(progress.done / progress.total, 0.0, 1.0) : 0.0;
  std::fprintf(stderr, "\r\033[K%3.0f %%  %.100s", 100 * share, progress.doing.c_str());
  std::fflush(stderr);
}

void ProgressLine::clear() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

}  // namespace clothlab::cli
