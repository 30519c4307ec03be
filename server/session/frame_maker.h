// Decides when a session packs a frame, of which encodings, and puts the finished ones into the mailbox.
// Nothing is packed that nobody asked for, and nothing twice while the state stands still.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>

#include "server/session/exchange.h"
#include "server/stream/packer.h"

namespace clothlab::session {

class FrameMaker {
 public:
  /// Its frames are numbered from after `last`.
  static Result<std::unique_ptr<FrameMaker>> create(Exchange& exchange, std::uint32_t last);

  /// Goes on where another, in another context, ends: with its viewers, its numbers and what its frames say.
  void take_over(const FrameMaker& other);
  std::uint32_t last() const { return requested_; }  ///< the number of its newest frame

  void demand(const Demand& demand, Clock::time_point now);
  /// The state has changed: the next frame due is worth making.
  void touch() { ++version_; }
  /// The same, and it is wanted at once (an edit while paused, a step by hand).
  void touch_now();
  /// The state was replaced (reset, another scene): frames made or under way of the old one are void.
  void restart();

  /// Queues what is wanted at once; called before stepping, so that a reset shows step 0.
  void make_urgent(const sim::Simulation& simulation, Clock::time_point now);
  /// Queues what is due by the clock.
  void make_due(const sim::Simulation& simulation, Clock::time_point now);
  /// Publishes what has arrived.
  void poll();
  /// Appends what packing a frame took lately.
  void poll_times(gl::StageTimes& out) { timer_.poll(out); }

  /// The state is the last good one again, after a blow-up: frames say so, and those on their way are void.
  void diverge();
  /// It goes on from there.
  void go_on();

  /// The cloth is at rest, and frames say so; or no longer.
  void asleep(bool asleep);

  bool in_flight() const { return requested_ != arrived_; }
  bool urgent() const;
  /// When the next frame is due if the state moves; far in the future if nobody wants one.
  Clock::time_point next_due() const;

 private:
  struct Lane {       // one encoding
    double rate = 0;  ///< [1/s]
    bool urgent = false;
    std::uint64_t packed_version = 0;
    Clock::time_point due{};
  };
  FrameMaker(Exchange& exchange, std::unique_ptr<stream::Packer> packer, std::uint32_t last);
  bool request(std::size_t lane, const sim::Simulation& simulation);
  void publish(stream::SharedMessage frame);

  Exchange& exchange_;
  std::unique_ptr<stream::Packer> packer_;
  gl::StageTimer timer_;
  std::array<Lane, encoding_count> lanes_{};
  std::uint32_t requested_ = 0;   ///< sequence number of the newest frame under way: the packer counts by one
  std::uint32_t arrived_ = 0;     ///< of the newest that came back, or that is void
  std::uint32_t void_until_ = 0;  ///< frames up to this one show a state that was replaced
  std::uint64_t version_ = 1;
  bool diverged_ = false, asleep_ = false;
};

}  // namespace clothlab::session
