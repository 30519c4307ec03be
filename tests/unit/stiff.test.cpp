// The reference for stiff cloth: its order, closed forms, and its agreement with RK4.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "server/reference/esdirk.h"
#include "server/reference/follower.h"
#include "server/reference/trajectory.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using reference::Pace;
using scene::Method;

namespace {

constexpr double precision = 1e-13;  // of a stage [m]: far below every error here

Pace even(double step) {
  return {Pace::Method::esdirk, step, {}, precision};
}

reference::State after(const reference::World& world, const Pace& pace, double time) {
  reference::Follower follower(world, pace, {});
  reference::State state = reference::at_rest(world);
  REQUIRE(follower.follow(state, 0.0, time));
  return state;
}

/// A sheet of finite elements that has all there is: damping, wind, air drag, a pin that swings.
scene::Scene busy_sheet(double damping) {
  scene::Scene scene = test::sheet_of_elements(Method::rk4, 1e-3, 6, damping);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.air_drag = 0.3;
  scene.wind = scene::Wind{};
  scene.wind->velocity = {1.0, 0.5, 2.0};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}},
                          {scene::AtCorner{5, 0}, scene::Oscillate{{0.0, 0.0, 1.0}, 0.02, 4.0}}};
  return scene;
}

/// Esdirk's ends after `steps` and twice as many, and how far the finer one is from RK4's.
struct Agreement {
  double estimate = 0, apart = 0, error = 0;  ///< [m]; the error is RK4's own
};
Agreement agreement(const reference::World& world, double time, int steps, double share_of_rate) {
  const auto exact = reference::trajectory(world, {time}, share_of_rate / reference::fastest_rate(world));
  REQUIRE(exact);
  const reference::State coarse = after(world, even(time / steps), time),
                         fine = after(world, even(time / (2 * steps)), time);
  return {reference::rms_distance(coarse.position, fine.position),
          reference::rms_distance(fine.position, exact->states[0].position), exact->error[0]};
}

}  // namespace

TEST_CASE("Esdirk's error falls as the third power of its step, and reaches a damped spring's closed form") {
  const double w = test::spring_omega, z = 0.1, wd = w * std::sqrt(1 - z * z), t = 1.5;
  const reference::World world = world_of(test::one_spring(Method::rk4, 1.0, 2 * z * w));
  const double exact = test::spring_balance + test::spring_amplitude * std::exp(-z * w * t) *
                                                  (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
  double before = 0.0;
  for (const int steps : {15, 30, 60, 120}) {
    const double off = after(world, even(t / steps), t).position[test::spring_end].z - exact;
    INFO(steps << " steps: off by " << off << " m, " << before / off << " times less");
    // The next term is of fourth order: w h, 0.4 at first, times a number of about 1 beside it, and half as
    // much each time.
    if (before != 0.0) CHECK(std::abs(std::log2(before / off) - 3.0) < 0.4 * 30.0 / steps + 0.02);
    before = off;
  }
  // Third order with an error of (w h)^3 / 24 a radian, of the amplitude.
  CHECK(std::abs(before) < 0.1 * w * t * std::pow(w * t / 120, 3) / 24);
}

TEST_CASE("a rod as stiff as steel swings like a rod at steps a hundred times as long as RK4 could take") {
  const double degrees = 90.0, factor = 1.180341, k = 1e10;
  const double quarter = 0.5 * std::numbers::pi * std::sqrt(1.0 / 9.81) * factor;
  const reference::World world = world_of(test::pendulum(Method::rk4, 1.0, degrees, k));
  const double dt = quarter / 200;
  CHECK(dt > 100.0 * 2.83 / reference::fastest_rate(world));
  const reference::State end = after(world, even(dt), quarter);
  const glm::dvec3 arm = end.position[test::spring_end] - end.position[0];
  const glm::dvec3 down = glm::normalize(world.scene.gravity);
  const double angle = std::atan2(glm::cross(down, arm).x, glm::dot(down, arm));
  INFO("the angle after a quarter of the period is " << angle << " rad");
  // Stages of second order: (4.43 rad/s dt)^2 / 24, as a chord is shorter than its arc, is 7e-6; and half of
  // the factor's last digit, at 4.43 rad/s, is 1e-6. Stages of first order leave 3e-3.
  CHECK(std::abs(angle) < 1e-5);
  CHECK(std::abs(glm::length(arm) - 1.0) < 2e-8);  // it stretches by 3 m g / k = 3e-9 m
}

TEST_CASE("Esdirk and RK4 agree within their own estimates on a sheet with damping, wind and a moving pin") {
  for (const double damping : {0.0, 2e-3}) {
    const reference::World world = world_of(busy_sheet(damping));
    const auto [estimate, apart, error] = agreement(world, 0.15, 100, 0.3);
    INFO("damping " << damping << " s: apart by " << apart << " m, estimates " << estimate << " m and "
                    << error);
    CHECK(apart < estimate + error);
    CHECK(estimate < 1e-4);
    CHECK(error < 1e-6);
  }
}

TEST_CASE("Esdirk and RK4 agree within their own estimates where a collider and a strain limit act") {
  scene::Scene scene = busy_sheet(2e-3);
  scene.wind.reset();
  scene.cloths[0].pins.pop_back();
  std::get<scene::Fem>(scene.cloths[0].material).strain_limit = scene::StrainLimit{0.02, 0.02};
  scene.colliders.emplace_back().shape = scene::Sphere{{0.0, -0.12, 0.0}, 0.08};
  const reference::World world = world_of(scene);
  const auto [estimate, apart, error] = agreement(world, 0.2, 200, 0.5);
  INFO("apart by " << apart << " m, estimates " << estimate << " m and " << error);
  // Contacts act once a step: the error falls as the step, so that the finer run is off by the estimate
  // again.
  CHECK(apart < 2.0 * estimate + error);
  CHECK(estimate < 2e-3);
}

TEST_CASE("a step of Newton's method with a stage's matrix undoes a small change of velocity") {
  struct {
    const char* name;
    scene::Scene scene;
  } cases[] = {{"springs", test::swinging_cloth(Method::rk4, 1e-3)}, {"finite elements", busy_sheet(2e-3)}};
  cases[0].scene.cloths[0].springs().damping = 1e-3;
  cases[1].scene.wind.reset();
  cases[1].scene.cloths[0].pins.pop_back();  // which moves: what turns in damping is left out of the matrix
  for (const auto& [name, scene] : cases) {
    const reference::World world = world_of(scene);
    std::mt19937 random(3);
    const auto around = [&](double size) {
      return size * (2.0 * static_cast<double>(random()) / 4294967296.0 - 1.0);
    };
    reference::Vectors x = world.model.start_position, v(x.size()), moved(x.size());
    const double cell = 0.03;
    for (glm::dvec3& place : x)
      place += glm::dvec3(around(0.1 * cell), around(0.1 * cell), around(0.1 * cell));
    for (glm::dvec3& change : moved) change = {around(1e-6), around(1e-6), around(1e-6)};
    reference::StageEquation equation(world);
    equation.set(x, v, 0.0, 1e-3);
    equation.places(v);
    REQUIRE(equation.factor(v, {}));
    const reference::Vectors here = equation.residual(v),
                             there = equation.residual(reference::plus(v, 1.0, moved));
    const reference::Vectors undone = equation.newton_step(reference::plus(there, -1.0, here));
    double most = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!world.pinned(i)) most = std::max(most, glm::length(undone[i] + moved[i]));
    INFO(name << ": " << most << " m/s of 1e-6 are left");
    CHECK(most <
          1e-10);  // a second derivative times the change: 1e-9 m over a cell, times a condition of 1e3
  }
}

TEST_CASE("a run of Esdirk that is told to stop stops before its next step") {
  const reference::World world = world_of(busy_sheet(0.0));
  std::stop_source stop;
  reference::Follower follower(world, even(1e-3), stop.get_token());
  reference::State state = reference::at_rest(world);
  REQUIRE(follower.follow(state, 0.0, 2e-3));
  const auto steps = follower.work().steps;
  stop.request_stop();
  CHECK_FALSE(follower.follow(state, 2e-3, 1.0));
  CHECK(follower.work().steps <= steps + 1);
}

TEST_CASE(
    "steps that Esdirk chooses are short where cloth is fast, and halving them halves the error thrice") {
  const double w = test::spring_omega, t = 1.5;
  const reference::World world = world_of(test::one_spring(Method::rk4, 1.0));
  const auto off = [&](const reference::State& state) {
    return std::abs(state.position[test::spring_end].z - test::spring_balance -
                    test::spring_amplitude * std::cos(w * t));
  };
  for (const double rate : {1e-5, 1e-6}) {
    reference::Scout scout(world, rate, precision, 1e-3, {});
    reference::State state = reference::at_rest(world);
    REQUIRE(scout.follow(state, 0.0, t));
    INFO("rate " << rate << " m/s: off by " << off(state) << " m in " << scout.work().steps << " steps");
    // Two of six vertices move: their error is sqrt(3) times the RMS.
    CHECK(off(state) < std::sqrt(3.0) * rate * t);
    const double half = off(after(world, scout.pace().halved(1), t));
    CHECK(off(state) / half > 5.0);
    CHECK(off(state) / half < 12.0);
  }
}

TEST_CASE("the reference takes RK4 for soft cloth, and Esdirk for a woven fabric") {
  CHECK(reference::cheaper_method(world_of(test::swinging_cloth(Method::rk4, 1e-3))) == Pace::Method::rk4);
  scene::Scene woven = test::sheet_of_elements(Method::rk4, 1e-3, 9, 1e-3);
  std::get<scene::Fem>(woven.cloths[0].material).warp = 2365.0;
  std::get<scene::Fem>(woven.cloths[0].material).weft = 3801.0;
  CHECK(reference::cheaper_method(world_of(woven)) == Pace::Method::esdirk);
}
