#include "server/session/run_state.h"

#include <string>
#include <vector>

#include "tests/catch.h"

using clothlab::session::RunState;
using State = RunState::State;

namespace {

/// One run in each possible state; held and diverged ones for each state that they return to.
struct Case {
  const char* name;
  RunState run;
};

RunState made(const std::vector<std::string>& transitions) {
  RunState run;
  for (const std::string& transition : transitions) {
    if (transition == "pause") run.pause();
    if (transition == "hold") REQUIRE(run.hold());
    if (transition == "fall asleep") REQUIRE(run.fall_asleep());
    if (transition == "diverge") run.diverge();
  }
  return run;
}

std::vector<Case> all() {
  return {{"playing", made({})},
          {"asleep", made({"fall asleep"})},
          {"paused", made({"pause"})},
          {"held", made({"hold"})},
          {"held asleep", made({"fall asleep", "hold"})},
          {"diverged while it played", made({"diverge"})},
          {"diverged while it was paused", made({"pause", "diverge"})},
          {"diverged while it was held", made({"hold", "diverge"})}};
}

}  // namespace

TEST_CASE("a session begins playing, and steps by the clock in that state alone") {
  CHECK(RunState().state() == State::playing);
  for (const Case& each : all()) {
    INFO(each.name);
    CHECK(each.run.steps() == (each.run.state() == State::playing));
  }
}

TEST_CASE("a run that has diverged is neither played nor stepped, and any other is") {
  for (Case each : all()) {
    INFO(each.name);
    const bool diverged = each.run.diverged();
    RunState stepped = each.run;
    CHECK(each.run.play() == !diverged);
    CHECK(each.run.state() == (diverged ? State::diverged : State::playing));
    CHECK(stepped.step_by_hand() == !diverged);
    CHECK(stepped.state() == (diverged ? State::diverged : State::paused));
  }
}

TEST_CASE("a pause is never refused, and outlasts a blow-up and the lab") {
  for (Case each : all()) {
    INFO(each.name);
    const bool diverged = each.run.diverged();
    each.run.pause();
    CHECK(each.run.diverged() == diverged);
    CHECK_FALSE(each.run.would_play());
    CHECK_FALSE(each.run.release());
    CHECK(each.run.go_on() == diverged);
    CHECK(each.run.state() == State::paused);
  }
}

TEST_CASE("the lab holds a run that plays or sleeps, and releases it if nobody has touched it since") {
  for (Case each : all()) {
    INFO(each.name);
    const State before = each.run.state();
    if (!each.run.plays()) {
      const bool held_before = each.run.state() == State::held;
      CHECK_FALSE(each.run.hold());
      CHECK(each.run.state() == before);
      CHECK((each.run.state() == State::held) == held_before);
      continue;
    }
    REQUIRE(each.run.hold());
    CHECK(each.run.state() == State::held);
    CHECK_FALSE(each.run.plays());
    CHECK(each.run.would_play());
    RunState touched = each.run;
    CHECK(each.run.release());
    CHECK(each.run.state() == before);
    REQUIRE(touched.step_by_hand());
    CHECK_FALSE(touched.release());
    CHECK(touched.state() == State::paused);
  }
}

TEST_CASE("only what plays falls asleep, and only what is at rest wakes") {
  for (Case each : all()) {
    INFO(each.name);
    RunState sleeper = each.run;
    CHECK(sleeper.fall_asleep() == each.run.steps());
    const bool at_rest = each.run.at_rest();
    const State before = each.run.state();
    CHECK(each.run.wake() == at_rest);
    CHECK_FALSE(each.run.at_rest());
    CHECK(each.run.state() == (before == State::asleep ? State::playing : before));
    CHECK_FALSE(each.run.wake());
  }
  RunState held = made({"fall asleep", "hold"});
  REQUIRE(held.wake());
  REQUIRE(held.release());
  CHECK(held.state() == State::playing);  // an event reached it while it was held
}

TEST_CASE("after a blow-up it goes on as it went before, awake") {
  for (Case each : all()) {
    INFO(each.name);
    const bool would_play = each.run.would_play();
    each.run.diverge();
    CHECK(each.run.diverged());
    CHECK_FALSE(each.run.plays());
    CHECK_FALSE(each.run.at_rest());
    CHECK(each.run.would_play() == would_play);
    each.run.diverge();  // diverging twice changes nothing
    CHECK(each.run.would_play() == would_play);
    REQUIRE(each.run.go_on());
    CHECK_FALSE(each.run.go_on());
    CHECK_FALSE(each.run.diverged());
    CHECK(each.run.would_play() == would_play);
  }
  RunState held = made({"hold", "diverge"});
  REQUIRE(held.release());
  CHECK(held.diverged());
  REQUIRE(held.go_on());
  CHECK(held.state() == State::playing);
}

TEST_CASE("at its beginning again it is awake, and stands still if it had diverged") {
  for (Case each : all()) {
    INFO(each.name);
    const RunState before = each.run;
    each.run.begin_again();
    CHECK_FALSE(each.run.at_rest());
    CHECK_FALSE(each.run.diverged());
    if (!before.diverged()) CHECK(each.run.would_play() == before.would_play());
    if (before.diverged()) CHECK_FALSE(each.run.plays());
  }
  RunState held = made({"hold", "diverge"});
  held.begin_again();
  CHECK(held.release());
  CHECK(held.state() == State::playing);
}
