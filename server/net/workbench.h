// Does for the service thread what takes long, one piece of work after another on a thread of its own:
// reading a long message, writing a large answer. Only the service thread uses this class.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace clothlab::net {

class Workbench {
 public:
  /// Runs on the service thread once the work is done; it must not count on anything of then being there
  /// still.
  using Ending = std::function<void()>;
  /// Runs on the bench's thread.
  using Work = std::function<Ending()>;

  /// `wake` makes the service thread call `pump`; it must not block.
  explicit Workbench(std::function<void()> wake) : wake_(std::move(wake)) {}
  ~Workbench() { stop(); }
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  /// Adds work; `failed` is its ending if it throws, for want of memory for example. The first call starts
  /// the thread.
  void add(Work work, Ending failed);
  /// Runs the endings of what has been done.
  void pump();
  /// Waits for the work under way, forgets all other, and ends the thread. No `add` is allowed afterwards.
  void stop();

 private:
  struct Task {
    Work work;
    Ending failed;
  };
  void run();

  const std::function<void()> wake_;
  std::mutex mutex_;  // held to move a task or an ending, never during work
  std::condition_variable task_arrived_;
  std::deque<Task> tasks_;
  std::vector<Ending> done_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace clothlab::net
