#include "server/reference/follower.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/reference/esdirk.h"
#include "server/reference/methods.h"

namespace clothlab::reference {

namespace {

constexpr int most_divisions =
    10;  // a step is halved at most this often where its equations cannot be solved
constexpr double smallest_step_share =
    1e-4;  // of the time to follow: shorter steps are taken whatever their error

}  // namespace

Follower::Follower(World world, Pace pace, const std::stop_token& stop)
    : world_(std::make_unique<World>(std::move(world))), pace_(std::move(pace)), stop_(stop) {
  if (pace_.method == Pace::Method::esdirk)
    esdirk_ = std::make_unique<Esdirk>(*world_, pace_.precision, stop);
}
Follower::Follower(Follower&&) noexcept = default;
Follower::~Follower() = default;

EsdirkWork Follower::work() const {
  return esdirk_ ? esdirk_->work() : EsdirkWork();
}

bool Follower::follow(State& state, double from, double to) {
  const std::vector<double> ends = between_keys(*world_, from, to);
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (!follow_smoothly(state, ends[i - 1], ends[i])) return false;
  return true;
}

bool Follower::follow_smoothly(State& state, double from, double to) {
  if (pace_.method == Pace::Method::rk4) {
    const auto steps = static_cast<std::int64_t>(std::ceil((to - from) / pace_.largest_step - 1e-9));
    const double dt = (to - from) / static_cast<double>(steps);
    world_->scene.solver.dt = dt;
    for (std::int64_t n = 0; n < steps; ++n) {
      if (stop_.stop_requested()) return false;
      const double at = static_cast<double>(n);
      advance(rk4, *world_, state, from + at * dt, from + (at + 1) * dt);
    }
    return true;
  }
  for (double t = from; t < to;) {
    const double step = pace_.step_at(t), steps = std::ceil((to - t) / step - 1e-6);
    const double next = steps <= 1.0 ? to : t + (to - t) / steps;
    if (!step_divided(state, t, next)) return false;
    t = next;
  }
  return true;
}

Follower::Outcome Follower::step(State& state, double from, double to) {
  if (!at_step(*world_, state, from).scene.keys.empty()) take_pins();
  const Mark before = mark(state);
  Esdirk::Outcome outcome = Esdirk::Outcome::done;
  const auto method = [&](const StepStart& start) {
    State next = start.state;
    outcome = esdirk_->step(start, next);
    return next;
  };
  world_->scene.solver.dt = to - from;
  advance(method, *world_, state, from, to);
  if (outcome == Esdirk::Outcome::done) return Outcome::done;
  go_back(before, state);
  return outcome == Esdirk::Outcome::stopped ? Outcome::stopped : Outcome::unsolved;
}

/// Pins let go with keys: then the equations are of other vertices.
void Follower::take_pins() {
  const World& now = at_time(*world_, 0.0);
  if (now.model.pin_motion == pins_) return;
  pins_ = now.model.pin_motion;
  const EsdirkWork work = esdirk_->work();
  esdirk_ = std::make_unique<Esdirk>(now, pace_.precision, stop_);
  esdirk_->set_work(work);
}

bool Follower::step_divided(State& state, double from, double to) {
  if (!at_step(*world_, state, from).scene.keys.empty()) take_pins();
  const Mark before = mark(state);
  for (int divisions = 0; divisions <= most_divisions; ++divisions) {
    const int parts = 1 << divisions;
    const double dt = (to - from) / parts;
    Outcome outcome = Outcome::done;
    for (int n = 0; n < parts && outcome == Outcome::done; ++n)
      outcome = step(state, from + n * dt, n + 1 == parts ? to : from + (n + 1) * dt);
    if (outcome == Outcome::stopped) return false;
    if (outcome == Outcome::done) return true;
    go_back(before, state);
  }
  return give_up(state);
}

Follower::Mark Follower::mark(const State& state) const {
  return {state, esdirk_->acceleration()};
}

void Follower::go_back(const Mark& to, State& state) {
  state = to.state;
  esdirk_->set_acceleration(to.acceleration);
}

bool Follower::give_up(State& state) {
  state.position.assign(state.position.size(), dvec3(std::numeric_limits<double>::quiet_NaN()));
  return true;
}

Scout::Scout(World world, double error_rate, double precision, double first_step, const std::stop_token& stop)
    : Follower(std::move(world), {Pace::Method::esdirk, 0.0, {}, precision}, stop),
      error_rate_(error_rate),
      step_(first_step) {}

bool Scout::follow(State& state, double from, double to, Clock::time_point deadline) {
  const std::vector<double> ends = between_keys(*world_, from, to);
  for (std::size_t i = 1; i < ends.size(); ++i)
    if (!follow_smoothly(state, ends[i - 1], ends[i], deadline)) return false;
  return true;
}

bool Scout::follow_smoothly(State& state, double from, double to, Clock::time_point deadline) {
  for (double t = from; t < to;) {
    if (late_ = Clock::now() > deadline; late_) return false;
    const double steps = std::ceil((to - t) / step_ - 1e-6), dt = (to - t) / std::max(steps, 1.0);
    const double next = steps <= 1.0 ? to : t + dt;
    const Mark before = mark(state);
    const Outcome outcome = step(state, t, next);
    if (outcome == Outcome::stopped) return false;
    const double error = esdirk_->error(), allowed = error_rate_ * dt;
    const bool smallest = dt < smallest_step_share * (to - from);
    if (outcome == Outcome::unsolved && smallest) return give_up(state);
    if (outcome == Outcome::unsolved || (!(error <= allowed) && !smallest)) {
      go_back(before, state);
      step_ =
          dt * (outcome == Outcome::unsolved ? 0.5 : std::clamp(0.9 * std::sqrt(allowed / error), 0.2, 0.9));
      continue;
    }
    if (pace_.pieces.empty() || std::abs(pace_.pieces.back().step - dt) > 1e-6 * dt)
      pace_.pieces.push_back({next, dt});
    pace_.pieces.back().until = next;
    pace_.largest_step = std::max(pace_.largest_step, dt);
    t = next;
    // A changed step needs a new factor: it changes only where that pays.
    const double longer = std::min(0.9 * std::sqrt(allowed / std::max(error, 1e-300)), 2.0) * dt;
    if (longer > 1.3 * step_) step_ = longer;
  }
  return true;
}

}  // namespace clothlab::reference
