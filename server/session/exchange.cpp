#include "server/session/exchange.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace clothlab::session {

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

JsonText text_of(const json& value) {
  return std::make_shared<const std::string>(value.dump(-1, ' ', false, json::error_handler_t::replace));
}

void Exchange::await_answer(Ticket ticket, std::optional<std::uint64_t> job, bool exports) {
  if (job)
    awaited_jobs_[*job] = std::move(ticket);
  else if (ticket.id || exports)
    awaited_[ticket.asker].push_back(std::move(ticket));
}

void Exchange::remove_awaited(const Ticket& answered) {
  const auto of = awaited_.find(answered.asker);
  if (of == awaited_.end()) return;
  const auto found = std::find_if(of->second.begin(), of->second.end(),
                                  [&](const Ticket& ticket) { return ticket.id == answered.id; });
  if (found != of->second.end()) of->second.erase(found);
  if (of->second.empty()) awaited_.erase(of);
}

void Exchange::remove_awaited(const Event& event) {
  if (const auto* reply = std::get_if<Reply>(&event))
    remove_awaited(reply->ticket);
  else if (const auto* captured = std::get_if<Captured>(&event))
    remove_awaited(Ticket{captured->asker, std::nullopt});
  else if (const auto* reached = std::get_if<SceneReached>(&event))
    awaited_jobs_.erase(reached->job);
}

void Exchange::give_up(const Error& error, std::vector<Event>& out) {
  const std::lock_guard lock(mutex_);
  const auto refuse = [&](const Ticket& ticket) {
    out.push_back(Reply{ticket, Refusal{Refusal::Reason::failed, error}});
  };
  for (const auto& [job, ticket] : awaited_jobs_) {
    out.push_back(SceneLost{job});
    if (ticket.id) refuse(ticket);
  }
  for (const auto& [asker, tickets] : awaited_)
    for (const Ticket& ticket : tickets)
      if (ticket.id)
        refuse(ticket);
      else
        out.push_back(Captured{asker, {}, error});
  awaited_.clear();
  awaited_jobs_.clear();
}

void Exchange::store_saved(std::shared_ptr<const Saved> saved) {
  const std::lock_guard lock(mutex_);
  saved_.swap(saved);  // the older state is freed after the lock is released
}

std::shared_ptr<const Saved> Exchange::saved() const {
  const std::lock_guard lock(mutex_);
  return saved_;
}

void Exchange::store_recording(RecordingFacts facts) {
  const std::lock_guard lock(mutex_);
  std::swap(recording_, facts);  // an older file is freed after the lock is released
}

RecordingFacts Exchange::recording() const {
  const std::lock_guard lock(mutex_);
  return recording_;
}

bool Exchange::offer(Command command) {
  {
    const std::lock_guard lock(mutex_);
    const auto* reach = std::get_if<ReachScene>(&command.what);
    const std::optional<std::uint64_t> job = reach ? std::optional(reach->job) : std::nullopt;
    const bool exports = std::holds_alternative<Export>(command.what);
    Ticket ticket = command.ticket;
    if (!commands_.offer(std::move(command))) return false;
    await_answer(std::move(ticket), job, exports);
  }
  commands_changed_.notify_one();
  return true;
}

void Exchange::post(Command command) {
  {
    const std::lock_guard lock(mutex_);
    commands_.post(std::move(command));
  }
  commands_changed_.notify_one();
}

void Exchange::leave(std::uint64_t asker) {
  const std::lock_guard lock(mutex_);
  left_[asker] = Clock::now();
}

void Exchange::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  commands_changed_.notify_one();
}

void Exchange::take_events(std::vector<Event>& out) {
  out.clear();
  const std::lock_guard lock(mutex_);
  if (!holding_) {
    out.swap(events_);
    return;
  }
  const auto held = events_.begin() + held_from_;
  std::move(events_.begin(), held, std::back_inserter(out));
  events_.erase(events_.begin(), held);
  held_from_ = 0;
}

stream::SharedMessage Exchange::frame(stream::Form form) const {
  const std::lock_guard lock(mutex_);
  return frames_[form.index()];
}

bool Exchange::wait_for_command(Clock::time_point until) {
  std::unique_lock lock(mutex_);
  commands_changed_.wait_until(lock, until, [&] { return stopping_ || !commands_.empty(); });
  return !stopping_;
}

std::optional<Command> Exchange::next_command() {
  const std::lock_guard lock(mutex_);
  for (auto left = left_.begin(); left != left_.end();) {
    if (Clock::now() - left->second < leave_time) {
      ++left;
      continue;
    }
    for (const Command& dropped : commands_.drop(left->first)) remove_awaited(dropped.ticket);
    left = left_.erase(left);
  }
  if (commands_.empty()) return std::nullopt;
  return commands_.pop();
}

void Exchange::spent(Clock::duration time) {
  const std::lock_guard lock(mutex_);
  commands_.spent(time);
}

std::optional<Exchange::GiveUp> Exchange::to_give_up(std::uint64_t asker, bool an_undo) const {
  const std::lock_guard lock(mutex_);
  if (stopping_) return GiveUp{};
  if (const auto left = left_.find(asker); left != left_.end() && Clock::now() - left->second >= leave_time)
    return GiveUp{GiveUp::Why::left};
  for (const Command* next : commands_.next_changes()) {
    const auto* travel = std::get_if<TravelHistory>(&next->what);
    if (travel && travel->direction == Direction::undo && !an_undo)
      return GiveUp{GiveUp::Why::undone, next->ticket};
    if (std::holds_alternative<LoadScene>(next->what)) return GiveUp{GiveUp::Why::loaded, next->ticket};
  }
  return std::nullopt;
}

bool Exchange::stopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

void Exchange::emit(Event event) {
  {
    const std::lock_guard lock(mutex_);
    remove_awaited(event);
    events_.push_back(std::move(event));
    if (holding_) return;
  }
  wake_();
}

void Exchange::hold_events() {
  const std::lock_guard lock(mutex_);
  holding_ = true;
  held_from_ = std::ssize(events_);
}

void Exchange::release_events() {
  {
    const std::lock_guard lock(mutex_);
    const bool none_held = held_from_ == std::ssize(events_);
    holding_ = false;
    held_from_ = 0;
    if (none_held) return;
  }
  wake_();
}

void Exchange::publish(const Status& status) {
  {
    const std::lock_guard lock(mutex_);
    const auto older = std::remove_if(events_.begin() + held_from_, events_.end(), [](const Event& event) {
      return std::holds_alternative<Status>(event);
    });
    events_.erase(older, events_.end());
    events_.push_back(status);
    if (holding_) return;
  }
  wake_();
}

void Exchange::publish(stream::SharedMessage frame) {
  const std::size_t slot = frame->header.form().index();
  {
    const std::lock_guard lock(mutex_);
    frames_[slot].swap(frame);  // the older frame is freed after the lock is released
  }
  wake_();
}

void Exchange::forget_frames() {
  const std::lock_guard lock(mutex_);
  for (stream::SharedMessage& frame : frames_) frame.reset();
}

void Exchange::forget_frame(stream::Form form) {
  const std::lock_guard lock(mutex_);
  frames_[form.index()].reset();
}

void Exchange::beat() {
  heartbeat_us_.store(now_us(), std::memory_order_relaxed);
}

}  // namespace clothlab::session
