// The error range that a choice promises, against closed forms: no step in between is worse.
#include <algorithm>
#include <cmath>

#include "server/lab/measure/choice.h"
#include "server/lab/measure/second_look.h"
#include "tests/scenes.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::lab;
using scene::Method;

namespace {

const scene::Scene spring = test::one_spring(Method::verlet, 0.001);

/// Largest error of a setting at any step up to `time`, over the size, by the closed form.
double largest_by_hand(const Setting& setting, double time, int steps) {
  scene::Scene scene = with(spring, setting);
  scene.solver.dt = time / steps;
  auto simulation = sim::Simulation::create(scene);
  REQUIRE(simulation);
  double largest = 0.0;
  for (int step = 1; step <= steps; ++step) {
    (*simulation)->step(1);
    const double z = (*simulation)->read_state().position[test::spring_end].z;
    const double exact =
        test::spring_balance + test::spring_amplitude * std::cos(test::spring_omega * time * step / steps);
    largest = std::max(largest, std::abs(z - exact));
  }
  return largest * std::sqrt(2.0 / 6.0);  // two of six vertices move, and the size is 1 m
}

Truth true_spring(double time) {
  Result<Truth> found = truth(spring, {time, 1e-8, 10.0}, {}, [](double) {});
  REQUIRE(found);
  REQUIRE(found->horizon == time);
  return std::move(*found);
}

}  // namespace

TEST_CASE(
    "a second look finds the largest error of all steps, where a run and the reference have few times in "
    "common") {
  const auto gpu = test::context();
  constexpr double time = 1.0;
  const Truth truth = true_spring(time);
  TrialRunner trials;
  // 20 steps have 4 of the 64 samples in common; of 60 steps each is looked at, of 600 every seventh.
  const std::vector<Setting> settings{{Method::symplectic_euler, time / 20, 1, 1e-4},
                                      {Method::verlet, time / 60, 1, 1e-4},
                                      {Method::symplectic_euler, time / 600, 1, 1e-4}};
  const auto errors = measure_largest_errors(spring, truth, settings, trials, {});
  REQUIRE(errors);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    INFO(text(settings[i]));
    REQUIRE((*errors)[i]);
    const LargestError& found = *(*errors)[i];
    const double exact = largest_by_hand(settings[i], time, steps_to_horizon(settings[i].dt, truth));
    const double rounding = 1e-6;  // float32 positions of about 1 m, RMS
    CHECK(found.low <= exact + rounding);
    CHECK(found.high >= exact - rounding);
    // The range must also be narrow: between two of 96 looks an oscillation of 0.6 periods changes little.
    CHECK(found.high <= 1.1 * exact + rounding);
  }
  // At the 4 common times, quarters of the time, the error seems smaller than it is: without a second look
  // the choice would promise that.
  const auto trial = trials.run(with(spring, settings[0]), truth, time, {});
  REQUIRE(trial);
  CHECK(*trial->largest_position_error < 0.98 * (*errors)[0]->seen);
}

TEST_CASE("a choice keeps the tolerance at every step, and its error bar holds a second simulation") {
  const auto gpu = test::context();
  for (const double tolerance : {1e-2, 2e-3}) {
    const Result<Choice> choice =
        choose(spring, {tolerance, {Method::symplectic_euler, Method::xpbd, Method::vbd}, 1.0}, {});
    if (!choice) FAIL(choice.error().text());
    REQUIRE(choice->met);
    const Point& chosen = choice->chosen;
    INFO(text(chosen.setting));
    REQUIRE(chosen.error_high);
    CHECK(*chosen.error_high <= tolerance);
    CHECK(*chosen.error_low <= *chosen.largest_position_error);
    const int steps = static_cast<int>(std::lround(1.0 / chosen.setting.dt));
    const double exact = largest_by_hand(chosen.setting, 1.0, steps);
    CHECK(exact <= *chosen.error_high + 1e-6);
    CHECK(exact >= *chosen.error_low - 1e-6);
    REQUIRE(chosen.cost);
    CHECK(chosen.cost->low <= chosen.cost->median);
    CHECK(chosen.cost->high >= chosen.cost->median);
    CHECK(std::isfinite(chosen.cost->high));
    REQUIRE(choice->runner_up);
    CHECK(*choice->runner_up->error_high <= tolerance);
  }
}

TEST_CASE("a second look that is cancelled ends") {
  const auto gpu = test::context();
  const Truth truth = true_spring(1.0);
  TrialRunner trials;
  std::stop_source stop;
  stop.request_stop();
  const std::vector<Setting> settings{{Method::explicit_euler, 1.0 / 64, 1, 1e-4}};
  const auto none = measure_largest_errors(spring, truth, settings, trials, stop.get_token());
  REQUIRE_FALSE(none);
  CHECK(was_cancelled(none.error()));
}
