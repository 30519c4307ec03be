// What waits to be sent to a client: texts, answers that are asked for one at a time, frames when they are
// due.
#include <libwebsockets.h>

#include <utility>

#include "server/net/client.h"
#include "server/net/methods.h"

namespace clothlab::net {

constexpr const char* not_read = "messages are not being read";

void Client::greet(const std::string& hello) {
  outbox_.push_first(make_text(hello));
  greeted_ = true;
  wake();
}

void Client::send(const std::string& text) {
  if (!outbox_.push_own(make_text(text))) close(close_policy, not_read);
  account_unread();
  wake();
}

void Client::send(SharedText text) {
  if (!outbox_.push(std::move(text))) close(close_policy, not_read);
  wake();
}

/// Has the server's memory know of what waits for this client alone, in whole units. Where there is no room
/// for it, who has read nothing for the longest time makes some.
void Client::account_unread() {
  const std::size_t bytes = outbox_.own_bytes() / unread_unit_bytes * unread_unit_bytes;
  while (bytes != unread_.bytes() && close_code_ == 0 && !unread_.resize(bytes))
    hub_.close_slowest_reader(*this);
}

void Client::forget_unread() {
  outbox_ = Outbox();
  sending_ = {};
  (void)unread_.resize(0);
}

void Client::send_status(SharedText text) {
  if (!outbox_.push_status(std::move(text))) close(close_policy, not_read);
  wake();
}

void Client::send_scene(SharedText text) {
  outbox_.push_scene(std::move(text));
  wake();
}

void Client::send_change(SharedText text, const std::function<SharedText()>& whole) {
  if (outbox_.crowded()) return send_scene(whole());
  if (!outbox_.push_change(std::move(text))) close(close_policy, not_read);
  wake();
}

bool Client::ask_at_length(session::Command command) {
  if (long_asked_.size() >= session::max_waiting_commands) return false;
  command.ticket.at_length = true;
  long_asked_.push_back(std::move(command));
  ask_next_at_length();
  return true;
}

void Client::ask_next_at_length() {
  if (!room_ || long_awaited_ || long_asked_.empty() || outbox_.crowded()) return;
  session::Command command = std::move(long_asked_.front());
  long_asked_.pop_front();
  const session::Ticket ticket = command.ticket;
  long_awaited_ = room_->offer(std::move(command));
  if (!long_awaited_) answer(ticket, too_many_waiting());
}

void Client::wake() {
  lws_callback_on_writable(wsi_);
}

void Client::close(int code, std::string reason) {
  if (close_code_ != 0) return;
  close_code_ = code;
  if (code == close_policy || code == close_too_big) ++hub_.metrics().over_limit;
  close_reason_ = std::move(reason);
  if (code != close_internal) forget_unread();
  read_on();  // what comes now is dropped
  wake();
  // The socket of a client that reads nothing never becomes writeable, so it is closed after 2 s.
  lws_set_timeout(wsi_, PENDING_TIMEOUT_CLOSE_SEND, 2);
}

void Client::subscribe(stream::Form form, double rate, int in_flight) {
  if (!pacing_.subscribed()) topology_sent_ = false;
  pacing_.subscribe(form, rate, in_flight, session::now_us());
  room_->demand_changed(form);
  wake();
}

void Client::unsubscribe() {
  pacing_.unsubscribe();
  room_->demand_changed(std::nullopt);
}

void Client::acknowledge(std::uint32_t sequence) {
  const std::int64_t now = session::now_us();
  pacing_.acknowledge(sequence, now);
  schedule_frame(now);
}

void Client::session_replaced() {
  topology_sent_ = false;
}

void Client::frame_arrived(stream::Form form, std::int64_t now) {
  if (!pacing_.subscribed() || pacing_.form() != form) return;
  if (frame_waits_) ++hub_.metrics().frames_skipped;
  frame_waits_ = true;
  schedule_frame(now);
}

void Client::schedule_frame(std::int64_t now) {
  const std::optional<std::int64_t> wait = pacing_.wait(now);
  if (!wait || role_ == Role::none) return;
  if (*wait == 0)
    wake();
  else
    lws_set_timer_usecs(wsi_, *wait);
}

}  // namespace clothlab::net
