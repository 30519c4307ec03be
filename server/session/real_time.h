// How many fixed steps are due: an accumulator that lets simulated time slow down rather than work pile up.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace clothlab::session {

/// Pure arithmetic on given times, so that it can be tested without waiting.
class RealTime {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Begins to count at `now`: on play, reset, a new speed, or after a pause. Nothing is owed yet.
  void restart(Time now);
  /// `factor` simulated seconds a second.
  void set_speed(double factor) { speed_ = factor; }
  double speed() const { return speed_; }

  /// Steps of `dt` [s] to do now: what is owed, but no more than fits the work budget of one turn. What is
  /// owed beyond `most_owed` seconds of wall time is given up.
  std::uint32_t due(Time now, double dt);
  /// Steps that fit the budget of one turn at the measured cost.
  std::uint32_t affordable() const;
  /// Whether the last `due` left steps undone.
  bool behind(double dt) const { return owed_ >= dt; }
  /// What a piece of work took [s], in which `steps` steps ended; of a step that takes several pieces, with
  /// those before it.
  void spent(std::uint32_t steps, double seconds);
  /// Of a step [s]; one that has not ended counts as far as it has come.
  double step_cost() const { return std::max(step_cost_, unfinished_); }

  /// Notes that simulated time was `simulated` [s] at `now`; about `status_rate` times a second.
  void sample(Time now, double simulated);
  /// Simulated seconds a second over the last second of samples; 0 before there are two.
  double factor() const;
  bool sampled() const { return sample_count_ >= 2; }

  static constexpr double turn_budget = 0.010;  ///< wall time one turn may spend stepping [s]
  static constexpr double most_owed = 0.050;    ///< [s] of wall time

 private:
  struct Sample {
    Time wall;
    double simulated = 0;
  };
  Time last_{};
  double owed_ = 0;  ///< simulated time [s]
  double speed_ = 1;
  double step_cost_ = 0;              ///< smoothed [s]; 0: not measured yet
  double unfinished_ = 0;             ///< spent on a step that has not ended yet [s]
  std::array<Sample, 11> samples_{};  ///< a ring
  std::size_t newest_ = 0, sample_count_ = 0;
};

}  // namespace clothlab::session
