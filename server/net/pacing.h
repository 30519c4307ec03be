// When a viewer gets its next frame, and when somebody talks too much. Pure arithmetic on given times [us].
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "server/net/limits.h"
#include "server/stream/frame.h"

namespace clothlab::net {

/// A viewer's subscription: a frame goes out when it is due by the viewer's rate and fewer than `in_flight`
/// are unacknowledged. Which frame that is, the latest, is decided at that moment.
class FramePacing {
 public:
  void subscribe(stream::Encoding encoding, double rate, int in_flight, std::int64_t now);
  void unsubscribe() { subscribed_ = false; }
  bool subscribed() const { return subscribed_; }
  stream::Encoding encoding() const { return encoding_; }
  double rate() const { return rate_; }

  /// Whether this frame is newer than the last one sent.
  bool is_news(std::uint32_t sequence) const { return !sent_any_ || newer(sequence, last_sent_); }
  /// Microseconds until the next frame may go: 0 now; nothing while only an acknowledgement can help.
  std::optional<std::int64_t> wait(std::int64_t now) const;
  /// Since when nothing on the viewer's side has held frames back.
  std::int64_t ready_since(std::int64_t now) const;

  void sent(std::uint32_t sequence, std::int64_t now);
  /// That frame and all before it; what was never sent is ignored.
  void acknowledge(std::uint32_t sequence, std::int64_t now);
  int unacknowledged() const { return count_; }

 private:
  // Sequence numbers may wrap around.
  static bool newer(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) > 0; }

  bool subscribed_ = false, sent_any_ = false;
  stream::Encoding encoding_ = stream::Encoding::q16;
  double rate_ = 60;         ///< [1/s]
  std::int64_t period_ = 0;  ///< [us]
  int in_flight_ = 2, count_ = 0;
  std::array<std::uint32_t, max_in_flight> unacknowledged_{};  ///< oldest first, `count_` of them
  std::uint32_t last_sent_ = 0;
  std::int64_t due_ = 0, unblocked_ = 0;
};

/// So many messages a second, and a burst.
class TokenBucket {
 public:
  TokenBucket(double rate, double burst, std::int64_t now)
      : rate_(rate), burst_(burst), tokens_(burst), last_(now) {}
  /// False: too many. What costs more than is left is let through, and paid off before the next.
  bool take(std::int64_t now, double cost = 1);
  /// Until one may be taken [us]; 0: now.
  std::int64_t wait(std::int64_t now) const;
  /// Whether the whole burst may be taken.
  bool full(std::int64_t now) const { return left(now) >= burst_; }

 private:
  double left(std::int64_t now) const;

  double rate_, burst_, tokens_;
  std::int64_t last_;
};

}  // namespace clothlab::net
