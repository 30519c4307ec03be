// Advances the reference from one time to another, by the method and with the steps that its pace says.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "server/base/thread_clock.h"
#include "server/reference/pace.h"
#include "server/reference/reference.h"

namespace clothlab::reference {

class Esdirk;

/// Advances states of `world` at a pace until `stop` is requested. Where Esdirk's equations cannot be solved,
/// a step is divided.
class Follower {
 public:
  Follower(World world, Pace pace, const std::stop_token& stop);
  Follower(Follower&&) noexcept;
  ~Follower();

  const World& world() const { return *world_; }
  /// From now on another pace of the same method.
  void set_pace(const Pace& pace) { pace_ = pace; }
  /// What Esdirk did.
  EsdirkWork work() const;

  /// Advances `state` from time `from` to time `to` [s]; false: stopped. Esdirk goes on from its last step:
  /// each state has a Follower of its own.
  bool follow(State& state, double from, double to);

 protected:
  bool follow_smoothly(State& state, double from, double to);
  void take_pins();
  enum class Outcome { done, unsolved, stopped };
  /// One step of Esdirk with contacts.
  Outcome step(State& state, double from, double to);
  /// The same in as many equal parts as it takes; where nothing solves them the state becomes not finite.
  bool step_divided(State& state, double from, double to);
  static bool give_up(State& state);

  /// All that a step changes.
  struct Mark {
    State state;
    std::vector<dvec3> acceleration;
  };
  Mark mark(const State& state) const;
  void go_back(const Mark& to, State& state);

  std::unique_ptr<World> world_;  // where Esdirk finds it
  Pace pace_;
  std::stop_token stop_;
  std::unique_ptr<Esdirk> esdirk_;
  std::vector<std::int32_t> pins_;  ///< of a scene with keys: pin_motion that esdirk_ was made for
};

/// Advances a state by Esdirk with steps that keep its error estimate, and so finds a pace.
class Scout : public Follower {
 public:
  using Clock = ThreadClock;

  /// `error_rate`: estimated error a second of motion [m/s]; `precision` as in Pace [m]; `first_step` [s].
  Scout(World world, double error_rate, double precision, double first_step, const std::stop_token& stop);

  /// Like Follower's; for rising times, one after another. False, too: it is past `deadline`, and `late`.
  bool follow(State& state, double from, double to, Clock::time_point deadline = Clock::time_point::max());
  bool late() const { return late_; }
  /// Up to where it has been.
  const Pace& pace() const { return pace_; }

 private:
  /// Between two times of keys.
  bool follow_smoothly(State& state, double from, double to, Clock::time_point deadline);

  double error_rate_, step_;
  bool late_ = false;
};

}  // namespace clothlab::reference
