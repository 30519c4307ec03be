// What commands that work for long share: they stop when asked to, and tell how far they are.
#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <stop_token>
#include <thread>

#include "server/lab/measure/control.h"

namespace clothlab::cli {

/// The code that shells give a program ended by Ctrl-C.
inline constexpr int exit_interrupted = 128 + SIGINT;

/// The first SIGINT (Ctrl-C) or SIGTERM asks the job to stop, the second ends the program as usual. Must be
/// made before any other thread: threads inherit the blocked signals only from then on.
class StopOnInterrupt {
 public:
  StopOnInterrupt();
  ~StopOnInterrupt();
  StopOnInterrupt(const StopOnInterrupt&) = delete;
  StopOnInterrupt& operator=(const StopOnInterrupt&) = delete;

  std::stop_token token() const { return stop_.get_token(); }

 private:
  void wait();

  std::stop_source stop_;
  std::atomic<bool> done_ = false;
  sigset_t signals_{}, before_{};
  std::thread thread_;
};

/// One line of progress on stderr, which `show` overwrites. Prints nothing if stderr is not a terminal.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine() { clear(); }
  void show(const lab::Progress& progress);
  void clear();

 private:
  const bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace clothlab::cli
