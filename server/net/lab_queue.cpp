#include "server/net/lab_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "server/base/text.h"
#include "server/net/limits.h"

namespace clothlab::net {

namespace {

using State = LabEntry::State;

RpcError no_such_job(std::uint64_t job) {
  return invalid_params("/job", std::to_string(job), "a job of yours; see lab.jobs");
}

}  // namespace

LabQueue::LabQueue(Port port, LabWorker::Open open, int most_seconds)
    : port_(std::move(port)),
      most_seconds_(most_seconds),
      worker_(std::make_unique<LabWorker>(std::move(open), port_.wake)) {}

std::variant<std::uint64_t, RpcError> LabQueue::admit(const session::Ticket& ticket, std::string session,
                                                      lab::Job job, LabWishes wishes) {
  const auto waiting = [&](auto counts) {
    return std::count_if(entries_.begin(), entries_.end(),
                         [&](const auto& item) { return item.second.waits() && counts(item.second); });
  };
  const auto refusal = [](const std::string& whose, int most) {
    return RpcError{error_over_limit,
                    whose + " " + std::to_string(most) +
                        " jobs waiting, which is the most; wait for one to end, or cancel one (lab.cancel)",
                    nullptr};
  };
  if (waiting([](const LabEntry&) { return true; }) >= max_lab_jobs)
    return refusal("the lab has", max_lab_jobs);
  if (waiting([&](const LabEntry& e) { return e.ticket.asker == ticket.asker; }) >= max_lab_jobs_a_client)
    return refusal("you have", max_lab_jobs_a_client);
  if (std::holds_alternative<lab::CompareRequest>(job)) forget_comparisons(ticket.asker);
  LabEntry entry;
  entry.id = ++last_id_;
  entry.ticket = ticket;
  entry.session = std::move(session);
  entry.job = std::move(job);
  entry.wishes = wishes;
  entries_.emplace(entry.id, std::move(entry));
  return last_id_;
}

void LabQueue::forget_comparisons(std::uint64_t client) {
  const auto kept = [](const auto& item) {
    return item.second.ended() && std::holds_alternative<lab::CompareRequest>(item.second.job);
  };
  std::erase_if(entries_, [&](const auto& item) { return item.second.ticket.asker == client && kept(item); });
  // the one that was asked for now makes one more
  while (std::count_if(entries_.begin(), entries_.end(), kept) >= max_comparisons)
    entries_.erase(std::find_if(entries_.begin(), entries_.end(), kept));
}

void LabQueue::choose_for(const std::string& session, SharedDocument document) {
  session_left(session);
  lab::ChooseRequest request;
  request.tolerance = document->scene.solver.tolerance;
  if (const std::optional<lab::Outcome> known = port_.known(*document, request)) {
    port_.chosen(session, std::move(document), std::get<lab::Choice>(*known));
    return;
  }
  LabEntry entry;
  entry.id = ++last_id_;
  entry.session = session;
  entry.job = request;
  entry.for_auto = true;
  entry.document = std::move(document);
  entry.state = State::queued;
  entries_.emplace(entry.id, std::move(entry));
  port_.wake();
}

void LabQueue::session_left(const std::string& session) {
  for (auto& [id, entry] : entries_)
    if (entry.for_auto && entry.session == session && !entry.ended()) {
      entry.for_auto = false;
      entry.cancelling = true;
      if (entry.state == State::running) worker_->stop_job();
    }
  port_.wake();
}

void LabQueue::scene_taken(std::uint64_t job, SharedDocument document, std::uint64_t revision) {
  const auto found = entries_.find(job);
  if (found == entries_.end()) return;  // the client has left
  LabEntry& entry = found->second;
  entry.document = std::move(document);
  entry.revision = revision;
  if (!entry.wishes.fresh && answer_from_cache(entry)) return;
  entry.state = State::queued;
  entry.progress.doing = "waits for its turn";
  count_ahead();
  port_.answer(entry.ticket, {{"job", job}, {"ahead", entry.ahead}, {"cached", false}});
}

bool LabQueue::answer_from_cache(LabEntry& entry) {
  std::optional<lab::Outcome> known = port_.known(*entry.document, entry.job);
  if (!known) return false;
  entry.outcome = std::make_shared<const lab::Outcome>(std::move(*known));
  entry.cached = true;
  port_.answer(entry.ticket, {{"job", entry.id}, {"ahead", 0}, {"cached", true}});
  close(entry, State::finished, session::now_us());
  return true;
}

void LabQueue::scene_changed(const std::string& session, const scene::Document& present) {
  for (auto& [id, entry] : entries_)
    if (entry.session == session && entry.document) {
      const bool stale = entry.stale_if(present.scene);
      if (std::exchange(entry.stale, stale) != stale) entry.progress_due = true;
    }
}

void LabQueue::held(std::uint64_t job) {
  const auto found = entries_.find(job);
  if (found == entries_.end() || found->second.state != State::holding) return;
  begin(found->second, session::now_us());
}

void LabQueue::session_replaced(const std::string& session) {
  const auto found = entries_.find(current_);
  if (found == entries_.end() || found->second.session != session) return;
  if (found->second.state == State::holding) begin(found->second, session::now_us());
}

void LabQueue::speed_reported(const std::string& session, double share, std::int64_t now) {
  const auto running = entries_.find(current_);
  if (running == entries_.end()) return;
  LabEntry& entry = running->second;
  const bool times = !std::holds_alternative<lab::CompareRequest>(entry.job);  // a comparison measures none
  const bool concerns =
      times && entry.state == State::running && entry.session == session && !entry.slow_notice_sent;
  if (!concerns || share >= least_share) {
    entry.slow_since = 0;
    return;
  }
  if (entry.slow_since == 0) entry.slow_since = now;
  if (now - entry.slow_since < slow_notice_delay) return;
  entry.slow_notice_sent = true;
  const std::string percent = std::to_string(static_cast<int>(100 * share));
  port_.notify(entry.ticket.asker, "notice",
               {{"level", "warning"},
                {"text", "while the lab measures, this session reaches " + percent +
                             " % of its speed, and the times that are measured are too long: pause the "
                             "session, or start the job with `pause`, which resumes it afterwards"}});
}

const LabEntry* LabQueue::find(std::uint64_t client, std::uint64_t job) const {
  const auto found = entries_.find(job);
  return found == entries_.end() || found->second.ticket.asker != client ? nullptr : &found->second;
}

std::variant<bool, RpcError> LabQueue::cancel(std::uint64_t client, std::uint64_t job) {
  if (!find(client, job)) return no_such_job(job);
  LabEntry& entry = entries_.at(job);
  if (entry.ended()) return false;
  entry.cancelling = true;
  if (entry.state == State::running) worker_->stop_job();
  port_.wake();
  return true;
}

json LabQueue::jobs(std::uint64_t client) const {
  json list = json::array();
  for (const auto& [id, entry] : entries_)
    if (entry.ticket.asker == client && entry.state != State::asked) list.push_back(entry.summary());
  return list;
}

std::variant<SharedOutcome, RpcError> LabQueue::outcome(std::uint64_t client, std::uint64_t job) const {
  const LabEntry* entry = find(client, job);
  if (!entry) return no_such_job(job);
  return entry->outcome;
}

void LabQueue::client_left(std::uint64_t client) {
  for (auto item = entries_.begin(); item != entries_.end();) {
    LabEntry& entry = item->second;
    const bool leaves = entry.ticket.asker == client;
    if (leaves && entry.id == current_) {
      entry.ticket = {};
      entry.cancelling = true;
      if (entry.state == State::running) worker_->stop_job();
      port_.wake();
    }
    item = leaves && entry.id != current_ ? entries_.erase(item) : std::next(item);
  }
}

void LabQueue::pump(std::int64_t now) {
  follow_running(now);
  end_cancelled(now);
  if (current_ == 0) start_next(now);
  count_ahead();
  for (auto& [id, entry] : entries_) send_due_messages(entry, now);
}

void LabQueue::follow_running(std::int64_t now) {
  const std::uint64_t steps = port_.steps(), before = std::exchange(steps_seen_, steps);
  if (current_ == 0 || worker_->idle()) return;
  LabEntry& entry = entries_.at(current_);
  LabWorker::Mail mail = worker_->take();
  entry.disturbed = entry.disturbed || steps > before;
  if (mail.progress) {
    entry.progress = std::move(*mail.progress);
    entry.progress_due = true;
  }
  if (mail.partial) {
    entry.outcome = std::move(mail.partial);
    entry.result_due = true;
  }
  if (mail.ended) return finish(entry, std::move(mail.ended->outcome), now);
  if (static_cast<double>(now - entry.began) * 1e-6 < most_seconds_ || entry.overdue) return;
  entry.overdue = true;
  worker_->stop_job();
}

void LabQueue::finish(LabEntry& entry, Result<lab::Outcome> outcome, std::int64_t now) {
  // A stopped job may hand over the results it has.
  if (outcome) entry.outcome = std::make_shared<const lab::Outcome>(std::move(*outcome));
  if (entry.cancelling) return close(entry, State::cancelled, now);
  if (outcome && !entry.overdue) {
    // Times measured while a session stepped may be too long, so they are not cached; nor are positions.
    if (!entry.disturbed && !std::holds_alternative<lab::Comparison>(*entry.outcome))
      port_.keep(*entry.document, entry.job, *entry.outcome);
    return close(entry, State::finished, now);
  }
  entry.error = entry.overdue ? Error{"lab", "it took more than " + formatted("%d s", most_seconds_),
                                      "a smaller scene, a shorter time or fewer methods"}
                              : outcome.error();
  close(entry, State::failed, now);
}

/// Ends cancelled jobs that do not run yet; a running job ends when the worker reports its end.
void LabQueue::end_cancelled(std::int64_t now) {
  std::vector<std::uint64_t> over;
  for (const auto& [id, entry] : entries_)
    if (entry.cancelling && (entry.state == State::queued || entry.state == State::holding))
      over.push_back(id);
  for (const std::uint64_t id : over) close(entries_.at(id), State::cancelled, now);
}

void LabQueue::close(LabEntry& entry, LabEntry::State state, std::int64_t now) {
  const double seconds = entry.began == 0 ? 0 : 1e-6 * static_cast<double>(now - entry.began);
  if (entry.id == current_) {
    current_ = 0;
    if (entry.wishes.pause) port_.release(entry.session);
  }
  entry.state = state;
  (state == State::finished ? totals_.finished
   : state == State::failed ? totals_.failed
                            : totals_.cancelled)++;
  totals_.seconds += seconds;
  entry.log_end(seconds);
  const std::uint64_t client = entry.ticket.asker;
  if (entry.for_auto && state == State::finished)
    port_.chosen(entry.session, entry.document, std::get<lab::Choice>(*entry.outcome));
  else if (entry.for_auto && entry.error)
    port_.chosen(entry.session, entry.document, *entry.error);
  if (client == 0) {
    entries_.erase(entry.id);
    return;
  }
  send_result(entry, now);
  forget_oldest(client);
}

void LabQueue::forget_oldest(std::uint64_t client) {
  const auto kept = [&](const auto& item) {
    return item.second.ticket.asker == client && item.second.ended();
  };
  if (std::count_if(entries_.begin(), entries_.end(), kept) > max_lab_outcomes_a_client)
    entries_.erase(std::find_if(entries_.begin(), entries_.end(), kept));
}

void LabQueue::start_next(std::int64_t now) {
  const auto next = std::find_if(entries_.begin(), entries_.end(),
                                 [](const auto& item) { return item.second.state == State::queued; });
  if (next == entries_.end()) return;
  LabEntry& entry = next->second;
  current_ = entry.id;
  if (!entry.wishes.pause) return begin(entry, now);
  entry.state = State::holding;
  port_.hold(entry.session, entry.id);
}

void LabQueue::begin(LabEntry& entry, std::int64_t now) {
  entry.state = State::running;
  entry.began = now;
  entry.progress = {0, 1, "starts"};
  entry.progress_due = true;
  steps_seen_ = port_.steps();
  worker_->begin({entry.id, entry.document, entry.job});
}

void LabQueue::count_ahead() {
  int ahead = 0;
  for (auto& [id, entry] : entries_) {
    if (entry.ended() || entry.state == State::asked) continue;
    if (std::exchange(entry.ahead, ahead) != ahead && entry.waits()) entry.progress_due = true;
    ++ahead;
  }
}

void LabQueue::send_due_messages(LabEntry& entry, std::int64_t now) {
  if (entry.ended() || entry.ticket.asker == 0) return;
  if (entry.progress_due && now - entry.progress_sent >= progress_period) {
    entry.progress_due = false;
    entry.progress_sent = now;
    port_.notify(entry.ticket.asker, "lab.progress", entry.progress_message());
  }
  if (entry.result_due && now - entry.result_sent >= result_period) send_result(entry, now);
}

void LabQueue::send_result(LabEntry& entry, std::int64_t now) {
  entry.result_due = false;
  entry.result_sent = now;
  port_.notify(entry.ticket.asker, "lab.result", entry.result_message());
}

void LabQueue::stop() {
  entries_.clear();
  current_ = 0;
  worker_.reset();
}

LabGauges LabQueue::gauges() const {
  LabGauges gauges = totals_;
  for (const auto& [id, entry] : entries_) {
    gauges.queued += entry.waits() ? 1u : 0u;
    gauges.running += entry.state == State::running ? 1u : 0u;
  }
  return gauges;
}

}  // namespace clothlab::net
