// Decides when a viewer gets its next frame, and when a client sends too many messages. Pure arithmetic: the
// caller passes the time `now` [us].
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "server/net/limits.h"
#include "server/stream/frame.h"

namespace clothlab::net {

/// A viewer's subscription. A frame is sent when one is due by the viewer's rate [1/s] and fewer than
/// `in_flight` frames are unacknowledged. The caller then sends the latest frame.
class FramePacing {
 public:
  void subscribe(stream::Form form, double rate, int in_flight, std::int64_t now);
  void unsubscribe() { subscribed_ = false; }
  bool subscribed() const { return subscribed_; }
  stream::Form form() const { return form_; }
  double rate() const { return rate_; }

  /// A frame of the form that was last subscribed to has been sent.
  bool sent_any() const { return sent_any_; }
  /// True if this frame is newer than the last one sent, or if none was sent.
  bool is_news(std::uint32_t sequence) const { return !sent_any_ || newer(sequence, last_sent_); }
  /// Time until the next frame may be sent [us], 0: now. Empty without a subscription, and while the viewer
  /// must first acknowledge a frame.
  std::optional<std::int64_t> wait(std::int64_t now) const;
  /// The time [us] since which neither the viewer's rate nor missing acknowledgements have held frames back.
  std::int64_t ready_since(std::int64_t now) const;

  void sent(std::uint32_t sequence, std::int64_t now);
  /// Marks this frame and all before it as acknowledged; ignores the number of a frame that was not sent yet.
  void acknowledge(std::uint32_t sequence, std::int64_t now);
  int unacknowledged() const { return count_; }

 private:
  // True if `a` is newer than `b`; right also where sequence numbers wrap around.
  static bool newer(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) > 0; }

  bool subscribed_ = false, sent_any_ = false;
  stream::Form form_ = stream::Encoding::q16;
  double rate_ = 60;         ///< [1/s]
  std::int64_t period_ = 0;  ///< [us]
  int in_flight_ = 2, count_ = 0;
  std::array<std::uint32_t, max_in_flight> unacknowledged_{};  ///< `count_` numbers, oldest first
  std::uint32_t last_sent_ = 0, newest_ = 0;  ///< of another form frames may be older than those before
  std::int64_t due_ = 0, unblocked_since_ = 0;
};

/// A rate limit: a bucket that gains `rate` tokens a second [1/s] and holds at most `burst` tokens.
class TokenBucket {
 public:
  TokenBucket(double rate, double burst, std::int64_t now)
      : rate_(rate), burst_(burst), tokens_(burst), last_(now) {}
  /// Takes `cost` tokens. False: less than one is left, and none is taken. A cost above what is left leaves a
  /// debt, which must be gained back first.
  bool take(std::int64_t now, double cost = 1);
  /// Takes `cost` tokens in any case; what is not there is a debt.
  void spend(std::int64_t now, double cost);
  /// Time until `take` can succeed [us]; 0: now.
  std::int64_t wait(std::int64_t now) const;
  /// True if the bucket is full.
  bool full(std::int64_t now) const { return left(now) >= burst_; }

 private:
  double left(std::int64_t now) const;

  double rate_, burst_, tokens_;
  std::int64_t last_;
};

}  // namespace clothlab::net
