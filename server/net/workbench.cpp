#include "server/net/workbench.h"

#include <exception>
#include <utility>

#include "server/base/log.h"
#include "server/base/priority.h"

namespace clothlab::net {

void Workbench::add(Work work, Ending failed) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back({std::move(work), std::move(failed)});
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  task_arrived_.notify_one();
}

void Workbench::pump() {
  std::vector<Ending> done;
  {
    const std::lock_guard lock(mutex_);
    done.swap(done_);
  }
  for (const Ending& ending : done) ending();
}

void Workbench::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

void Workbench::run() {
  lower_priority(5);  // below the sessions, above the pictures (session/exporter.h)
  while (true) {
    Task task;
    {
      std::unique_lock lock(mutex_);
      task_arrived_.wait(lock, [&] { return ending_ || !tasks_.empty(); });
      if (ending_) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    Ending ending;
    try {
      ending = task.work();
    } catch (const std::exception& error) {
      log(LogLevel::error, "work_failed", {{"why", error.what()}});
      ending = std::move(task.failed);
    }
    task = {};  // what the work held is freed here
    {
      const std::lock_guard lock(mutex_);
      done_.push_back(std::move(ending));
    }
    wake_();
  }
}

}  // namespace clothlab::net
