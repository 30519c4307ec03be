// Coulomb's law on a slope: below its limit a cloth stands, above it slides with g (sin a - mu cos a).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/scene/method.h"
#include "tests/resting.h"
#include "tests/sides.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// Distance that the cloth has slid down the slope after `seconds`, the mean of its vertices [m].
double slid(Side side, scene::Scene scene, Method method, double dt, double seconds) {
  scene.solver.method = method;
  scene.solver.dt = dt;
  Stepped stepped(side, scene);
  const reference::State before = stepped.state();
  stepped.step(static_cast<int>(std::lround(seconds / dt)));
  const reference::State after = stepped.state();
  double sum = 0.0;
  for (std::size_t i = 0; i < before.position.size(); ++i) sum += before.position[i].x - after.position[i].x;
  return sum / static_cast<double>(before.position.size());
}

}  // namespace

TEST_CASE(
    "implicit Euler: a sheet on a slope stands while tan(angle) < friction and slides as Coulomb says") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const int columns : {2, 9, 33}) {
      const bool large = columns == 33;
      if (large && side == Side::reference) continue;
      for (const double dt : {0.001, 0.004, 0.008, 0.016}) {
        for (const double degrees : {5.0, 15.0, 30.0}) {
          // Every slope with one step, every step on one slope: they do not depend on each other.
          if (degrees != 15.0 && (large || dt != 0.008)) continue;
          if (large && dt < 0.008) continue;
          if (!thorough() && (large || dt == 0.004)) continue;
          for (const double friction : {0.0, 0.1, 0.3, 0.6, 1.0}) {
            if (dt == 0.001 && friction != 0.1 && friction != 0.3)
              continue;  // one that slides, one that stands
            const double angle = degrees * std::numbers::pi / 180.0, seconds = 0.48;
            const double pull =
                std::max(0.0, standard_gravity * (std::sin(angle) - friction * std::cos(angle)));
            const double expected = 0.5 * pull * seconds * seconds;
            const double found =
                slid(side, sheet_on_slope(degrees, friction, columns), Method::implicit_euler, dt, seconds);
            // Order 1: positions follow the velocity at the step's end, half a step ahead; and the law of a
            // contact may act a step late. The solver's tolerance is 1e-4 of gravity.
            const double late = standard_gravity * dt * seconds;
            INFO(name(side) << ", " << columns << " columns, dt " << dt << " s, " << degrees
                            << " degrees, friction " << friction << ": " << found << " m, by the law "
                            << expected << " m");
            if (pull > 0.0)
              CHECK(std::abs(found - expected) < late * pull / standard_gravity + 1e-3 * expected);
            else
              CHECK(std::abs(found) < 1e-4);
          }
        }
      }
    }
  }
}

TEST_CASE(
    "implicit Euler: a conveyor takes a sheet along with mu g until both are as fast, then carries it") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const double dt : {0.001, 0.004, 0.016}) {
      for (const double friction : {0.1, 0.5}) {
        const double speed = 0.5, seconds = 0.8;
        scene::Scene scene = sheet_on_slope(0.0, friction);
        scene.colliders[0].motion = scene::Linear{{-speed, 0.0, 0.0}};
        // time at which it reaches the conveyor's speed
        const double late = speed / (friction * standard_gravity);
        const double expected = speed * (seconds - 0.5 * late);
        const double found = slid(side, scene, Method::implicit_euler, dt, seconds);
        INFO(name(side) << ", dt " << dt << " s, friction " << friction << ": " << found << " m, by the law "
                        << expected << " m");
        REQUIRE(late < seconds);
        // One step early or late, at the beginning and at the end.
        CHECK(std::abs(found - expected) < 2.0 * speed * dt + 1e-3 * expected);
      }
    }
  }
}

TEST_CASE(
    "a sheet that friction holds on a slope stands under every method that meets contacts once a step") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const Method method :
         {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
      for (const double dt : {0.0003, 0.001, 0.002}) {
        scene::Scene scene = sheet_on_slope(15.0, 0.3);
        const double found = slid(side, scene, method, dt, 0.5);
        INFO(name(side) << ", " << scene::name(method) << ", dt " << dt << " s: " << found << " m");
        CHECK(std::abs(found) < 1e-4);
      }
    }
  }
}
