#include "server/session/real_time.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clothlab::session {

namespace {
constexpr std::uint32_t first_steps = 32;      // per turn, while the cost is unknown
constexpr std::uint32_t most_steps = 100'000;  // per turn, however low the cost
double in_seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}
}  // namespace

void RealTime::restart(Time now) {
  last_ = now;
  owed_ = 0;
  sample_count_ = 0;
}

std::uint32_t RealTime::affordable() const {
  if (step_cost_ <= 0) return first_steps;
  const double steps = std::clamp(turn_budget / step_cost_, 1.0, double{most_steps});
  return static_cast<std::uint32_t>(steps);
}

std::uint32_t RealTime::due(Time now, double dt) {
  owed_ = std::min(owed_ + in_seconds(now - last_) * speed_, std::max(most_owed * speed_, dt));
  last_ = now;
  // 1e-9 makes up for rounding: a debt that is 17 steps but for rounding counts as 17.
  const double whole = std::floor(owed_ / dt + 1e-9);
  const double steps = std::min(whole, static_cast<double>(affordable()));
  owed_ = std::max(0.0, owed_ - steps * dt);
  return static_cast<std::uint32_t>(steps);
}

void RealTime::add_work_time(std::uint32_t steps, double wall) {
  unfinished_ += wall;
  if (steps == 0) return;
  const double cost = std::max(std::exchange(unfinished_, 0.0), 1e-9) / steps;
  // The cost rises fast and falls slowly, because a turn that takes too long delays every command and frame.
  step_cost_ = cost > step_cost_ ? 0.5 * (step_cost_ > 0 ? step_cost_ : cost) + 0.5 * cost
                                 : 0.9 * step_cost_ + 0.1 * cost;
}

void RealTime::sample(Time now, double simulated) {
  newest_ = (newest_ + 1) % samples_.size();
  samples_[newest_] = {now, simulated};
  sample_count_ = std::min(sample_count_ + 1, samples_.size());
}

double RealTime::factor() const {
  if (sample_count_ < 2) return 0;
  const Sample& last = samples_[newest_];
  const Sample& first = samples_[(newest_ + samples_.size() - sample_count_ + 1) % samples_.size()];
  const double wall = in_seconds(last.wall - first.wall);
  return wall > 0 ? (last.simulated - first.simulated) / wall : 0;
}

}  // namespace clothlab::session
