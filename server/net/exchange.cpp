#include "server/net/exchange.h"

#include "server/net/limits.h"

namespace clothlab::net {

std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch()).count();
}

bool Exchange::offer(Command command) {
  {
    const std::lock_guard lock(mutex_);
    if (commands_.size() >= max_waiting_commands) return false;
    commands_.push_back(std::move(command));
  }
  commands_changed_.notify_one();
  return true;
}

void Exchange::post(Command command) {
  {
    const std::lock_guard lock(mutex_);
    commands_.push_back(std::move(command));
  }
  commands_changed_.notify_one();
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
  out.swap(events_);
}

bool Exchange::take_status(Status& out) {
  const std::lock_guard lock(mutex_);
  if (!status_new_) return false;
  out = status_;
  status_new_ = false;
  return true;
}

stream::SharedMessage Exchange::frame(stream::Encoding encoding) const {
  const std::lock_guard lock(mutex_);
  return frames_[static_cast<std::size_t>(encoding)];
}

bool Exchange::take_commands(std::vector<Command>& out, Clock::time_point until) {
  out.clear();
  std::unique_lock lock(mutex_);
  commands_changed_.wait_until(lock, until, [&] { return stopping_ || !commands_.empty(); });
  while (!commands_.empty() && out.size() < commands_a_turn) {
    out.push_back(std::move(commands_.front()));
    commands_.pop_front();
  }
  return !stopping_;
}

void Exchange::emit(Event event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::move(event));
  }
  wake_();
}

void Exchange::publish(const Status& status) {
  {
    const std::lock_guard lock(mutex_);
    status_ = status;
    status_new_ = true;
  }
  wake_();
}

void Exchange::publish(stream::SharedMessage frame) {
  const auto slot = static_cast<std::size_t>(frame->header.encoding);
  {
    const std::lock_guard lock(mutex_);
    frames_[slot].swap(frame);  // the older frame is freed after the lock
  }
  wake_();
}

void Exchange::forget_frames() {
  const std::lock_guard lock(mutex_);
  for (stream::SharedMessage& frame : frames_) frame.reset();
}

void Exchange::forget_frame(stream::Encoding encoding) {
  const std::lock_guard lock(mutex_);
  frames_[static_cast<std::size_t>(encoding)].reset();
}

void Exchange::beat() {
  heartbeat_us_.store(now_us(), std::memory_order_relaxed);
}

}  // namespace clothlab::net
