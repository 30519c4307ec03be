// The one thread on which the lab measures: it runs one job at a time, with a GL context of its own and at
// the lowest priority, and hands over what it finds. This is the service thread's handle.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "server/lab/job.h"
#include "server/scene/document.h"

namespace clothlab::net {

using SharedOutcome = std::shared_ptr<const lab::Outcome>;
using SharedDocument = std::shared_ptr<const scene::Document>;

class LabWorker {
 public:
  /// Does a job, on the worker's thread; `lab::run` in the server.
  using Run = std::function<Result<lab::Outcome>(const scene::Document&, const lab::Job&,
                                                 const lab::Control<lab::Outcome>&)>;
  /// Makes the worker's thread fit to run jobs, on that thread; tried again at the next job if it fails. The
  /// Run is destroyed there too.
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
  /// What has come since the last look, of everything only the newest.
  struct Mail {
    std::optional<lab::Progress> progress;
    SharedOutcome partial;
    std::optional<Ended> ended;
  };

  /// `wake` is called on the worker's thread after something was put out; it must not block.
  LabWorker(Open open, std::function<void()> wake) : open_(std::move(open)), wake_(std::move(wake)) {}
  /// Stops the job that runs and waits for it: as long as a job takes to look at its stop token.
  ~LabWorker();
  LabWorker(const LabWorker&) = delete;
  LabWorker& operator=(const LabWorker&) = delete;

  /// Nothing runs, and the end of what ran has been taken.
  bool idle() const { return !busy_; }
  /// The worker must be idle. The first task starts the thread.
  void begin(Task task);
  /// Asks the running job to stop; it ends like any other.
  void stop_job() { stop_.request_stop(); }
  Mail take();

 private:
  void run();
  Result<lab::Outcome> carry_out(const Task& task, const std::stop_token& stop, std::optional<Run>& job);
  template <class Put>
  void put(Put into_mail);

  const Open open_;
  const std::function<void()> wake_;
  bool busy_ = false;      // the service thread's own
  std::stop_source stop_;  // of the running job; likewise

  std::mutex mutex_;  // held to move a pointer, never while anything is computed
  std::condition_variable task_arrived_;
  std::optional<Task> task_;
  std::stop_token task_stop_;
  bool ending_ = false;
  Mail mail_;
  bool mail_waits_ = false;
  std::thread thread_;
};

/// The server's Open: lowers the calling thread's priority, then makes a GL context whose helper threads
/// inherit it. Error: no usable OpenGL.
Result<LabWorker::Run> open_lab(std::optional<int> gpu);

}  // namespace clothlab::net
