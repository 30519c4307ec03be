#include "server/net/stepper.h"

#include <algorithm>
#include <utility>

namespace clothlab::net {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

Result<std::unique_ptr<Stepper>> Stepper::create(scene::Document document, Exchange& exchange,
                                                 double patience) {
  auto stepper = std::unique_ptr<Stepper>(new Stepper(std::move(document), exchange, patience));
  Result<std::unique_ptr<sim::Simulation>> simulation = sim::Simulation::create(stepper->document_.scene);
  if (!simulation) return simulation.error();
  stepper->simulation_ = std::move(*simulation);
  Result<std::unique_ptr<FrameMaker>> frames = FrameMaker::create(exchange);
  if (!frames) return frames.error();
  stepper->frames_ = std::move(*frames);
  stepper->last_watched_ = stepper->next_status_ = Clock::now();
  stepper->announce_scene(std::nullopt, 0);
  stepper->announce_passes();
  stepper->step_limit_.follow(stepper->simulation_->model(), stepper->document_.scene);
  return stepper;
}

Clock::time_point Stepper::turn(std::vector<Command>& commands) {
  exchange_.beat();
  for (Command& command : commands) handle(command);
  const Clock::time_point now = Clock::now();
  if (watchers_ > 0) last_watched_ = now;
  frames_->make_urgent(*simulation_, now);
  advance(now);
  frames_->make_urgent(*simulation_, now);
  frames_->make_due(*simulation_, Clock::now());
  frames_->poll();
  follow_diagnostics(Clock::now());
  return next_turn(Clock::now());
}

void Stepper::advance(Clock::time_point now) {
  const auto spent = [&](std::uint32_t steps, double wall) { real_time_.spent(steps, wall); };
  backlog_.poll(now, spent);
  const bool run = running(now);
  if (run && !was_running_) real_time_.restart(now);
  was_running_ = run;
  if (backlog_.full()) return;
  std::uint32_t steps = 0;
  if (pending_steps_ > 0)
    // No further than the next answer, which tells the step it was asked for.
    steps = static_cast<std::uint32_t>(std::min<std::uint64_t>(
        waiting_.front().until_step - simulation_->step_index(), real_time_.affordable()));
  else if (run)
    steps = real_time_.due(now, document_.scene.solver.dt);
  if (steps == 0) return;
  const Clock::time_point begun = Clock::now();
  simulation_->step(steps);
  backlog_.push(steps, begun);
  backlog_.poll(Clock::now(), spent);
  ++state_version_;
  exchange_.count_steps(steps);
  if (pending_steps_ == 0) return frames_->touch();
  pending_steps_ -= steps;
  frames_->touch();
  if (pending_steps_ == 0) frames_->touch_now();
  finish_waiting(false);
}

void Stepper::finish_waiting(bool all) {
  const auto done = [&](const Waiting& waiting) {
    if (!all && waiting.until_step > simulation_->step_index()) return false;
    if (diverged_)
      reply(waiting.ticket, diverged_error());
    else
      reply(waiting.ticket, where_we_are());
    return true;
  };
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(), done), waiting_.end());
  if (all) pending_steps_ = 0;
}

void Stepper::follow_diagnostics(Clock::time_point now) {
  if (now >= next_status_) {
    const auto period = duration_cast<Clock::duration>(duration<double>(1.0 / status_rate));
    next_status_ = std::max(next_status_ + period, now);
    if (!suspended(now)) request_status(now);
  }
  sim::Diagnostics arrived;
  if (!diagnosing_ || !simulation_->poll_diagnostics(arrived)) return;
  diagnosing_ = false;
  const bool stale = std::exchange(diagnosis_is_stale_, false);
  if (stale) return;
  accept(arrived);
  publish_status(now);
}

// Of a state that has moved the status waits for its diagnosis; of one that has not it is sent again.
void Stepper::request_status(Clock::time_point now) {
  if (diagnosing_ || diverged_ || diagnosed_version_ == state_version_) return publish_status(now);
  simulation_->request_diagnostics();
  diagnosing_ = true;
  diagnosed_version_ = state_version_;
}

void Stepper::accept(const sim::Diagnostics& diagnostics) {
  if (!diagnostics.finite) return diverge();
  diagnostics_ = diagnostics;
  warn_if_crowded();
  // On its way to infinity a blow-up is finite for a while: that is no state to keep for the viewers.
  constexpr double beyond_any_cloth = 10;
  if (diagnostics.max_strain < beyond_any_cloth) frames_->confirm(diagnostics.step);
}

void Stepper::diverge() {
  if (diverged_) return;
  diverged_ = true;
  resume_on_load_ = playing_;
  playing_ = false;
  finish_waiting(true);
  frames_->diverge();
  const double dt = document_.scene.solver.dt;
  exchange_.emit(Diverged{
      "the cloth's positions stopped being finite numbers after t = " + json(diagnostics_.time).dump() +
          " s: the time step of " + json(dt).dump() + " s is too long for this stiffness and mass",
      "halve the time step, then reset",
      {{"solver", {{"dt", dt / 2}}}}});
}

void Stepper::publish_status(Clock::time_point now) {
  if (was_running_) real_time_.sample(now, simulation_->time());
  Status status;
  status.playing = playing_;
  status.diverged = diverged_;
  status.speed = real_time_.speed();
  status.real_time_factor = was_running_ ? real_time_.factor() : 0;
  follow_step_limit();
  status.dt_limit = step_limit_.dt_limit();
  status.margin = step_limit_.margin();
  status.diagnostics = diagnostics_;
  exchange_.publish(status);
  warn_if_slow(now);
}

void Stepper::follow_step_limit() {
  step_limit_.poll();
  if (std::optional<std::string> warning = step_limit_.take_warning())
    exchange_.emit(Notice{"warning", std::move(*warning)});
}

void Stepper::warn_if_slow(Clock::time_point now) {
  const double factor = real_time_.factor();
  if (!was_running_ || factor <= 0 || factor > 0.9 * real_time_.speed()) {
    slow_since_ = now;
    return;
  }
  if (slow_announced_ || now - slow_since_ < seconds(3)) return;
  slow_announced_ = true;
  exchange_.emit(Notice{"warning",
                        "this machine cannot keep up: time runs slower than asked for; a smaller cloth, a "
                        "longer time step or a lower speed helps"});
}

void Stepper::warn_if_crowded() {
  if (crowded_announced_ || diagnostics_.neighbours_dropped == 0) return;
  crowded_announced_ = true;
  exchange_.emit(Notice{
      "warning",
      "self-collision: some vertices have more neighbours than are looked at, the nearest 64; a smaller "
      "thickness or a coarser mesh helps"});
}

bool Stepper::suspended(Clock::time_point now) const {
  return watchers_ == 0 && duration<double>(now - last_watched_).count() > patience_;
}

Clock::time_point Stepper::next_turn(Clock::time_point now) const {
  if (pending_steps_ > 0 && !backlog_.full()) return now;
  if (frames_->urgent() || frames_->in_flight() || diagnosing_ || !backlog_.empty())
    return now + microseconds(500);
  if (!running(now)) return suspended(now) ? now + milliseconds(250) : std::max(next_status_, now);
  if (real_time_.behind(document_.scene.solver.dt)) return now;
  return std::min({now + milliseconds(10), next_status_, std::max(frames_->next_due(), now)});
}

}  // namespace clothlab::net
