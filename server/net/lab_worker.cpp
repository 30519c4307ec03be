#include "server/net/lab_worker.h"

#include <exception>
#include <new>
#include <utility>

#include "server/base/priority.h"
#include "server/gl/context.h"
#include "server/gl/software/software.h"
#include "server/model/size.h"
#include "server/session/fault.h"
#include "server/sim/list_memory.h"
#include "server/sim/memory.h"

namespace clothlab::net {

LabWorker::~LabWorker() {
  if (!thread_.joinable()) return;
  stop_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  task_arrived_.notify_one();
  thread_.join();
}

void LabWorker::begin(Task task) {
  busy_ = true;
  stop_ = std::stop_source();
  {
    const std::lock_guard lock(mutex_);
    mail_ = {};
    task_ = std::move(task);
    task_stop_ = stop_.get_token();
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  task_arrived_.notify_one();
}

LabWorker::Mail LabWorker::take() {
  Mail mail;
  {
    const std::lock_guard lock(mutex_);
    std::swap(mail, mail_);
    mail_waits_ = false;
  }
  if (mail.ended) busy_ = false;
  return mail;
}

/// Changes the mail. Calls `wake_` only for the first change after a `take`, because a job may report far
/// more often than the service thread looks.
template <class Put>
void LabWorker::put(Put into_mail) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    into_mail(mail_);
    wake = !std::exchange(mail_waits_, true);
  }
  if (wake) wake_();
}

void LabWorker::run() {
  std::optional<Run> job;
  while (true) {
    Task task;
    std::stop_token stop;
    {
      std::unique_lock lock(mutex_);
      task_arrived_.wait(lock, [&] { return ending_ || task_; });
      if (ending_) return;
      task = *std::exchange(task_, std::nullopt);
      stop = task_stop_;
    }
    Result<lab::Outcome> outcome = carry_out(task, stop, job);
    // The GL context may have caused the failure, so the next job gets a new one.
    if (!outcome && !lab::was_cancelled(outcome.error())) job.reset();
    put([&](Mail& mail) { mail.ended.emplace(Ended{task.id, std::move(outcome)}); });
  }
}

Result<lab::Outcome> LabWorker::carry_out(const Task& task, const std::stop_token& stop,
                                          std::optional<Run>& job) {
  try {
    if (!job) {
      Result<Run> opened = open_();
      if (!opened) return opened.error();
      job = std::move(*opened);
    }
    if (stop.stop_requested()) return lab::cancelled;
    lab::Control<lab::Outcome> control;
    control.stop = stop;
    control.progress = [this](const lab::Progress& progress) {
      put([&](Mail& mail) { mail.progress = progress; });
    };
    control.arrived = [this](const lab::Outcome& partial) {
      auto copy = std::make_shared<const lab::Outcome>(partial);
      put([&](Mail& mail) { mail.partial.swap(copy); });
    };
    session::provoke_fault(session::fault_in_lab, task.id);
    return (*job)(*task.document, task.job, control);
  } catch (const std::bad_alloc&) {
    return Error{"lab", "there was not enough memory", "ask for fewer methods, or of a smaller scene"};
  } catch (const std::exception& error) {
    return Error{"lab", error.what(), "ask again; please report it if it happens twice"};
  }
}

Result<LabWorker::Run> open_lab(std::optional<int> gpu, std::shared_ptr<MemoryBudget> budget) {
  lower_priority(19);
  return LabWorker::Run([gpu, budget](const scene::Document& document, const lab::Job& job,
                                      const lab::Control<lab::Outcome>& control) -> Result<lab::Outcome> {
    // It simulates the scene under one method after the other: as much as the one that keeps the most.
    scene::Scene largest = document.scene;
    largest.solver.method = scene::Method::implicit_euler;
    const Result<MemoryBudget::Reservation> place = sim::reserve_memory(budget, largest);
    if (!place) return place.error();
    sim::ListMemory::of_thread() = std::make_shared<sim::ListMemory>(budget);
    // With helper threads or without, whichever is faster for this scene, as sessions and the command line
    // compute; else the costs would be another's.
    const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(
        gpu, gl::HelperThreads::lab, !gl::needs_no_helper_threads(model::size_of(document.scene).vertices));
    if (!context) return context.error();
    Result<lab::Outcome> outcome = lab::run(document, job, control);
    if ((*context)->lost() || session::fault_due(session::Fault::context_lost, session::fault_in_lab, 0))
      return Error{"OpenGL", "the device was reset while it measured, and nothing on it can be trusted",
                   "ask again"};
    return outcome;
  });
}

}  // namespace clothlab::net
