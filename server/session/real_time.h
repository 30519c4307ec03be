// How many fixed steps are due by the clock. On a machine that is too slow simulated time slows down, instead
// of a growing number of steps being owed.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace clothlab::session {

/// Computes from given times only, so that tests need not wait.
class RealTime {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Begins to count at `now`, with no steps owed: on play, reset, a new speed, or after a pause.
  void restart(Time now);
  /// `factor`: simulated seconds per second.
  void set_speed(double factor) { speed_ = factor; }
  double speed() const { return speed_; }

  /// The number of steps of `dt` [s] to do now: those owed, but no more than fit the time of one turn. Steps
  /// owed beyond `most_owed` seconds of wall time are dropped, but one step may always be owed.
  std::uint32_t due(Time now, double dt);
  /// The number of steps that fit the time of one turn at the measured cost; at least 1.
  std::uint32_t affordable() const;
  /// True if the last `due` left steps owed.
  bool behind(double dt) const { return owed_ >= dt; }
  /// Takes in that a piece of work, in which `steps` steps ended, took `seconds` [s]. The times of several
  /// pieces of one step are added up.
  void add_work_time(std::uint32_t steps, double seconds);
  /// The measured cost of a step [s], smoothed; at least the time spent so far on the unfinished step.
  double step_cost() const { return std::max(step_cost_, unfinished_); }

  /// Takes in that simulated time was `simulated` [s] at `now`; called about `status_rate` times a second.
  void sample(Time now, double simulated);
  /// Simulated seconds per second, over about the last second; 0 before there are two samples.
  double factor() const;
  bool sampled() const { return sample_count_ >= 2; }

  static constexpr double turn_budget = 0.010;  ///< wall time one turn may spend stepping [s]
  static constexpr double most_owed = 0.050;    ///< wall time for which steps may be owed [s]

 private:
  struct Sample {
    Time wall;
    double simulated = 0;
  };
  Time last_{};
  double owed_ = 0;  ///< simulated time that is due but not stepped [s]
  double speed_ = 1;
  double step_cost_ = 0;              ///< smoothed [s]; 0: not measured yet
  double unfinished_ = 0;             ///< time spent on a step that has not ended yet [s]
  std::array<Sample, 11> samples_{};  ///< a ring buffer
  std::size_t newest_ = 0, sample_count_ = 0;
};

}  // namespace clothlab::session
