// The thread on which the lab measures: it runs one job at a time, with its own GL context and at the lowest
// priority, and hands over the results. A LabWorker is the service thread's handle to that thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "server/base/memory_budget.h"
#include "server/lab/job.h"
#include "server/scene/document.h"

namespace clothlab::net {

using SharedOutcome = std::shared_ptr<const lab::Outcome>;
using SharedDocument = std::shared_ptr<const scene::Document>;

class LabWorker {
 public:
  /// Runs a job on the worker's thread; in the server it calls `lab::run`.
  using Run = std::function<Result<lab::Outcome>(const scene::Document&, const lab::Job&,
                                                 const lab::Control<lab::Outcome>&)>;
  /// Prepares the worker's thread for jobs; called on that thread before the first job, and again before the
  /// next job after a failure. The Run is destroyed on that thread too.
  using Open = std::function<Result<Run>()>;

  struct Task {
    std::uint64_t id = 0;
    SharedDocument document;
    lab::Job job;
  };
  struct Ended {
    std::uint64_t id = 0;
    Result<lab::Outcome> outcome;
  };
  /// What the worker has put out since the last `take`, only the newest of each kind.
  struct Mail {
    std::optional<lab::Progress> progress;
    SharedOutcome partial;
    std::optional<Ended> ended;
  };

  /// `wake` is called on the worker's thread after something was put out; it must not block.
  LabWorker(Open open, std::function<void()> wake) : open_(std::move(open)), wake_(std::move(wake)) {}
  /// Stops the running job and waits for its end, which comes when the job next checks its stop token.
  ~LabWorker();
  LabWorker(const LabWorker&) = delete;
  LabWorker& operator=(const LabWorker&) = delete;

  /// True if no job runs and `take` has returned the end of the last one.
  bool idle() const { return !busy_; }
  /// The worker must be idle. The first task starts the thread.
  void begin(Task task);
  /// Asks the running job to stop; its end is reported like any other job's.
  void stop_job() { stop_.request_stop(); }
  Mail take();

 private:
  void run();
  Result<lab::Outcome> carry_out(const Task& task, const std::stop_token& stop, std::optional<Run>& job);
  template <class Put>
  void put(Put into_mail);

  const Open open_;
  const std::function<void()> wake_;
  bool busy_ = false;      // used by the service thread only
  std::stop_source stop_;  // stops the running job; used by the service thread only

  std::mutex mutex_;  // held only to move a pointer, never during a computation
  std::condition_variable task_arrived_;
  std::optional<Task> task_;
  std::stop_token task_stop_;
  bool ending_ = false;
  Mail mail_;
  bool mail_waits_ = false;
  std::thread thread_;
};

/// The server's Open: lowers the calling thread's priority, then makes a GL context whose helper threads
/// inherit that priority. Each job reserves memory of `budget` (null: any). Error: no usable OpenGL.
Result<LabWorker::Run> open_lab(std::optional<int> gpu, std::shared_ptr<MemoryBudget> budget = nullptr);

}  // namespace clothlab::net
