#include "server/session/frame_maker.h"

#include <algorithm>
#include <cmath>

#include "server/stream/collider_text.h"

namespace clothlab::session {

namespace {

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

Result<std::unique_ptr<FrameMaker>> FrameMaker::create(Exchange& exchange, std::uint32_t last) {
  Result<std::unique_ptr<stream::Packer>> packer = stream::Packer::create(last);
  if (!packer) return packer.error();
  return std::unique_ptr<FrameMaker>(new FrameMaker(exchange, std::move(*packer), last));
}

FrameMaker::FrameMaker(Exchange& exchange, std::unique_ptr<stream::Packer> packer, std::uint32_t last)
    : exchange_(exchange),
      packer_(std::move(packer)),
      requested_(last),
      arrived_(last),
      discard_until_(last) {}

void FrameMaker::take_over(const FrameMaker& other) {
  lanes_ = other.lanes_;
  version_ = other.version_;
  diverged_ = other.diverged_;
  asleep_ = other.asleep_;
  state_changed_now();
}

void FrameMaker::demand(const Demand& demand, Clock::time_point now) {
  for (std::size_t i = 0; i < form_count; ++i) {
    Lane& lane = lanes_[i];
    if (lane.rate <= 0 && demand.rate[i] > 0) lane.due = now;
    lane.rate = demand.rate[i];
    if (demand.fresh[i]) lane.urgent = true;
  }
}

void FrameMaker::record(double rate, Clock::time_point now) {
  Lane& lane = lanes_[recording_lane];
  lane.rate = rate;
  lane.due = now;
  lane.urgent = rate > 0;
}

/// True if this frame was made for the recording. Frames arrive in the order of their numbers, but some never
/// do.
bool FrameMaker::for_recording(std::uint32_t sequence) {
  while (!to_record_.empty() && to_record_.front() < sequence) to_record_.pop_front();
  if (to_record_.empty() || to_record_.front() != sequence) return false;
  to_record_.pop_front();
  return true;
}

void FrameMaker::state_changed_now() {
  state_changed();
  for (Lane& lane : lanes_) lane.urgent = true;
}

void FrameMaker::restart() {
  discard_until_ = arrived_ = requested_;  // frames under way may still arrive, or be dropped with their mesh
  diverged_ = false;
  state_changed_now();
  exchange_.forget_frames();
}

bool FrameMaker::request(std::size_t index, const sim::Simulation& simulation) {
  const auto flags = (diverged_ ? stream::flag_diverged : 0) | (asleep_ ? stream::flag_asleep : 0);
  const stream::Form form = form_at(index);
  if (form.encoding == stream::Encoding::c16) {
    if (compressor_.full()) return false;
    compressor_.set_mesh(simulation.model(), simulation.topology_revision());
  }
  timer_.begin();
  const bool queued = packer_->request(simulation, form, static_cast<std::uint16_t>(flags),
                                       stream::collider_text(simulation));
  if (queued) timer_.stage("pack_frame");
  timer_.end();
  if (!queued) return false;
  ++requested_;
  if (index == recording_lane) to_record_.push_back(requested_);
  lanes_[index].packed_version = version_;
  return true;
}

void FrameMaker::make_urgent(const sim::Simulation& simulation, Clock::time_point now) {
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Lane& lane = lanes_[i];
    if (!lane.urgent) continue;
    if (lane.rate > 0 && !request(i, simulation)) continue;  // no room for it on its way: try again later
    lane.urgent = false;
    if (lane.rate > 0) lane.due = now + period(lane.rate);
  }
}

void FrameMaker::make_due(const sim::Simulation& simulation, Clock::time_point now) {
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Lane& lane = lanes_[i];
    if (lane.rate <= 0 || now < lane.due || lane.packed_version == version_) continue;
    if (!request(i, simulation)) continue;
    // Frames are due at equal intervals; after a gap the intervals start anew.
    lane.due = std::max(lane.due + period(lane.rate), now);
  }
}

void FrameMaker::poll() {
  while (stream::SharedMessage frame = packer_->poll()) {
    const bool recorded = for_recording(frame->header.sequence);
    if (frame->header.sequence <= discard_until_) continue;
    arrived_ = frame->header.sequence;
    if (recorded)
      recorded_.push_back(std::move(frame));
    else if (frame->header.encoding == stream::Encoding::c16)
      compressor_.offer(std::move(frame));
    else
      publish(std::move(frame));
  }
  while (stream::SharedMessage frame = compressor_.poll())
    if (frame->header.sequence > discard_until_) publish(std::move(frame));
}

void FrameMaker::publish(stream::SharedMessage frame) {
  // Frames of a blow-up are shown until it is noticed, except those that cannot be drawn.
  if (finite(frame->header.box_minimum) && finite(frame->header.box_extent))
    exchange_.publish(std::move(frame));
}

void FrameMaker::diverge() {
  restart();
  diverged_ = true;
}

void FrameMaker::go_on() {
  diverged_ = false;
  state_changed_now();
}

void FrameMaker::asleep(bool asleep) {
  asleep_ = asleep;
  state_changed_now();
}

bool FrameMaker::urgent() const {
  return std::any_of(lanes_.begin(), lanes_.end(),
                     [](const Lane& lane) { return lane.urgent && lane.rate > 0; });
}

Clock::time_point FrameMaker::next_due() const {
  Clock::time_point next = Clock::time_point::max();
  for (const Lane& lane : lanes_)
    if (lane.rate > 0) next = std::min(next, lane.due);
  return next;
}

}  // namespace clothlab::session
