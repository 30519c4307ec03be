// Decides when a session packs a frame and in which forms, and publishes finished frames. Only forms
// that viewers want are packed, and an unchanged state is packed again only if a frame is wanted at once.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "server/session/exchange.h"
#include "server/stream/compressor.h"
#include "server/stream/packer.h"

namespace clothlab::session {

class FrameMaker {
 public:
  /// The first frame has the number `last` + 1.
  static Result<std::unique_ptr<FrameMaker>> create(Exchange& exchange, std::uint32_t last);

  /// Continues the work of a frame maker in another context: takes over its demands and its frames' flags.
  void take_over(const FrameMaker& other);
  std::uint32_t last() const { return requested_; }  ///< the number of the newest requested frame

  void demand(const Demand& demand, Clock::time_point now);
  /// From now on also makes frames for a recording, in f32, `rate` a second [1/s]; 0: no more.
  void record(double rate, Clock::time_point now);
  /// The frames for the recording that have arrived.
  std::vector<stream::SharedMessage> take_recorded() { return std::exchange(recorded_, {}); }
  /// The state has changed: a frame is made when the next is due.
  void state_changed() { ++version_; }
  /// The state has changed, and a frame of each wanted form is made at once (an edit while paused, a step
  /// by hand).
  void state_changed_now();
  /// The state was replaced (reset, another scene): discards the frames of the old state.
  void restart();

  /// Queues the frames that are wanted at once. Called before stepping too, so that a reset shows step 0.
  void make_urgent(const sim::Simulation& simulation, Clock::time_point now);
  /// Queues the frames that are due by the clock.
  void make_due(const sim::Simulation& simulation, Clock::time_point now);
  /// Publishes the frames that have arrived from the GPU, those of c16 once they are compressed.
  void poll();
  /// Appends the GPU time that the packing of a recent frame took, if it has arrived.
  void poll_times(gl::StageTimes& out) { timer_.poll(out); }

  /// After a blow-up the last good state was restored: discards older frames, and flags new ones as diverged.
  void diverge();
  /// The simulation goes on after a blow-up: new frames are no longer flagged as diverged.
  void go_on();

  /// Sets whether new frames are flagged as asleep: the cloth is at rest.
  void asleep(bool asleep);

  /// True while requested frames have not arrived.
  bool in_flight() const { return requested_ != arrived_ || compressor_.busy(); }
  bool urgent() const;
  /// When the next frame is due if the state moves; far in the future if nobody wants one.
  Clock::time_point next_due() const;

 private:
  struct Lane {       // the state of one form, or of the recording
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
  stream::Compressor compressor_;
  gl::StageTimer timer_;
  static constexpr std::size_t recording_lane = form_count;
  static stream::Form form_at(std::size_t lane) {
    return lane == recording_lane ? stream::Form(stream::Encoding::f32) : stream::Form::at(lane);
  }
  bool for_recording(std::uint32_t sequence);

  std::array<Lane, form_count + 1> lanes_{};
  std::deque<std::uint32_t> to_record_;  ///< numbers of the frames on their way to the recording
  std::vector<stream::SharedMessage> recorded_;
  std::uint32_t requested_ = 0;      ///< sequence number of the newest requested frame, as in the packer
  std::uint32_t arrived_ = 0;        ///< sequence number of the newest frame that arrived or was discarded
  std::uint32_t discard_until_ = 0;  ///< frames up to this number are discarded: their state was replaced
  std::uint64_t version_ = 1;
  bool diverged_ = false, asleep_ = false;
};

}  // namespace clothlab::session
