#include "server/session/real_time.h"

#include <algorithm>

#include "tests/catch.h"

using clothlab::session::RealTime;
using Time = RealTime::Time;

namespace {
constexpr double dt = 0.001;
Time at(double seconds) {
  return Time{} + std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds));
}

/// Number of steps done in `seconds`, in turns of `turn` seconds, on a machine where a step costs `cost`
/// seconds.
double run(RealTime& clock, double seconds, double turn, double cost) {
  double now = 0, steps = 0;
  while (now < seconds) {
    const std::uint32_t due = clock.due(at(now), dt);
    clock.add_work_time(due, due * cost);
    steps += due;
    now += std::max(turn, due * cost);
  }
  return steps;
}
}  // namespace

TEST_CASE("a machine that keeps up does one step for each dt that passes") {
  RealTime clock;
  clock.restart(at(0));
  const double steps = run(clock, 10.0, 0.007, 1e-5);
  // All steps except those that the last turn had not seen yet.
  CHECK(steps <= 10.0 / dt);
  CHECK(steps >= (10.0 - 0.007) / dt - 1);
}

TEST_CASE("speed multiplies the steps") {
  RealTime clock;
  clock.set_speed(0.25);
  clock.restart(at(0));
  CHECK(run(clock, 10.0, 0.01, 1e-5) == Approx(2500).margin(4));
}

TEST_CASE("a machine that cannot keep up slows time instead of doing ever more a turn") {
  RealTime clock;
  clock.restart(at(0));
  constexpr double cost = 0.004;  // four times real time
  double now = 0, longest = 0, steps = 0;
  while (now < 20.0) {
    const std::uint32_t due = clock.due(at(now), dt);
    clock.add_work_time(due, due * cost);
    if (now > 1.0) longest = std::max(longest, due * cost);
    steps += due;
    now += std::max(1e-4, due * cost);
  }
  CHECK(steps == Approx(20.0 / cost).epsilon(0.02));  // no idle time either
  CHECK(longest <= RealTime::turn_budget);
}

TEST_CASE("a pause of the machine is not caught up") {
  RealTime clock;
  clock.restart(at(0));
  run(clock, 1.0, 0.01, 1e-6);
  CHECK(clock.due(at(3600.0), dt) <= RealTime::most_owed / dt + 1);
}

TEST_CASE("even the dearest step is done, one a turn") {
  RealTime clock;
  clock.restart(at(0));
  clock.due(at(0.01), dt);
  clock.add_work_time(1, 5.0);
  CHECK(clock.affordable() == 1);
  CHECK(clock.due(at(0.02), dt) == 1);
}

TEST_CASE("a step longer than the debt allowed is still done in its time") {
  RealTime clock;
  clock.restart(at(0));
  constexpr double long_dt = 0.2;
  int steps = 0;
  for (int turn = 0; turn <= 1000; ++turn) {
    const std::uint32_t due = clock.due(at(turn * 0.01), long_dt);
    clock.add_work_time(due, due * 1e-4);
    steps += static_cast<int>(due);
  }
  CHECK(steps >= 49);
  CHECK(steps <= 50);
}

TEST_CASE("the real-time factor is simulated over wall time, of the last second") {
  RealTime clock;
  clock.restart(at(0));
  CHECK(clock.factor() == 0);
  for (int i = 0; i <= 30; ++i) clock.sample(at(0.1 * i), i <= 15 ? 0.1 * i : 1.5 + 0.05 * (i - 15));
  CHECK(clock.factor() == Approx(0.5));
}
