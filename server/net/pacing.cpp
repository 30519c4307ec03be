#include "server/net/pacing.h"

#include <algorithm>
#include <cmath>

namespace clothlab::net {

void FramePacing::subscribe(stream::Form form, double rate, int in_flight, std::int64_t now) {
  if (!subscribed_ || form != form_) sent_any_ = false;  // all frames of this form are new to the viewer
  if (!subscribed_) count_ = 0;
  subscribed_ = true;
  form_ = form;
  rate_ = rate;
  period_ = static_cast<std::int64_t>(1e6 / rate);
  in_flight_ = in_flight;
  due_ = unblocked_since_ = now;
}

std::optional<std::int64_t> FramePacing::wait(std::int64_t now) const {
  if (!subscribed_ || count_ >= in_flight_) return std::nullopt;
  // Frames come at the viewer's rate, a little early or late: a quarter of a period early is not too early.
  return std::max<std::int64_t>(0, due_ - period_ / 4 - now);
}

std::int64_t FramePacing::ready_since(std::int64_t now) const {
  return std::min(now, std::max(unblocked_since_, due_ - period_ / 4));
}

void FramePacing::sent(std::uint32_t sequence, std::int64_t now) {
  newest_ = count_ == 0 || newer(sequence, newest_) ? sequence : newest_;
  sent_any_ = true;
  last_sent_ = sequence;
  unacknowledged_[static_cast<std::size_t>(count_++)] = sequence;
  due_ = std::max(due_, now - period_) + period_;
}

void FramePacing::acknowledge(std::uint32_t sequence, std::int64_t now) {
  if (count_ == 0 || newer(sequence, newest_)) return;
  const bool blocked = count_ >= in_flight_;
  int kept = 0;
  for (int i = 0; i < count_; ++i) {
    const std::uint32_t waiting = unacknowledged_[static_cast<std::size_t>(i)];
    if (newer(waiting, sequence)) unacknowledged_[static_cast<std::size_t>(kept++)] = waiting;
  }
  count_ = kept;
  if (blocked && count_ < in_flight_) unblocked_since_ = now;
}

double TokenBucket::left(std::int64_t now) const {
  return std::min(burst_, tokens_ + rate_ * 1e-6 * static_cast<double>(now - last_));
}

std::int64_t TokenBucket::wait(std::int64_t now) const {
  const double missing = 1 - left(now);
  return missing > 0 ? std::max<std::int64_t>(1, std::llround(1e6 * missing / rate_)) : 0;
}

void TokenBucket::spend(std::int64_t now, double cost) {
  tokens_ = left(now) - cost;
  last_ = now;
}

bool TokenBucket::take(std::int64_t now, double cost) {
  tokens_ = left(now);
  last_ = now;
  if (tokens_ < 1) return false;
  tokens_ -= cost;
  return true;
}

}  // namespace clothlab::net
