// The law of the wind on a triangle, and what is known of a whole scene's wind, in double precision.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "server/model/motion.h"
#include "server/model/wind.h"
#include "server/reference/wind.h"
#include "tests/catch.h"
#include "tests/scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using elements::Wind;
using elements::wind_load;
using glm::dvec3;

namespace {

constexpr double rounding = 1e-14;  // some dozens of roundings in double precision

/// A flow of this speed that meets a triangle, whose normal is y, at `angle` [rad] from its plane.
dvec3 flow(double speed, double angle) {
  return speed * dvec3(std::cos(angle), std::sin(angle), 0.0);
}
const dvec3 crossed(0.0, 0.02, 0.0);  // of a triangle of 0.01 m^2

template <class Check>
void at_random(Check check) {
  std::mt19937 random(3);
  std::normal_distribution<double> number;
  for (int n = 0; n < 2000; ++n) {
    const Wind wind{std::abs(number(random)), std::abs(number(random))};
    const dvec3 u(number(random), number(random), number(random)),
        c(number(random), number(random), number(random));
    check(wind, 5.0 * u, 0.01 * c);
  }
}

}  // namespace

TEST_CASE(
    "flow along the normal presses with density A / 2 drag |u|^2, and slanted flow lifts as published") {
  const double rho = 1.2, area = 0.01, drag = 1.3, lift = 0.4;
  const auto straight = wind_load({drag, lift}, flow(3.0, std::numbers::pi / 2), crossed);
  CHECK(glm::distance(straight.force, dvec3(0.0, rho * area / 2 * drag * 9.0, 0.0)) < rounding);
  for (const double angle : {0.1, 0.7, 2.0, 4.0, 6.0}) {
    const dvec3 u = flow(3.0, angle), n(0.0, 1.0, 0.0);
    const double through = glm::dot(u, n);
    const dvec3 expected =
        rho * area / 2 * (drag * std::abs(through) * u + lift * through * (3.0 * n - through / 3.0 * u));
    CHECK(glm::distance(wind_load({drag, lift}, u, crossed).force, expected) < rounding);
  }
}

TEST_CASE("drag takes energy from the flow, lift is across the flow") {
  at_random([](Wind wind, const dvec3& u, const dvec3& c) {
    CHECK(glm::dot(wind_load({wind.drag, 0.0}, u, c).force, u) >= 0.0);
    const auto across = wind_load({0.0, wind.lift}, u, c);
    CHECK(std::abs(glm::dot(across.force, u)) <= rounding * across.braking * glm::dot(u, u));
  });
}

TEST_CASE("a triangle feels the same from both of its sides") {
  at_random([](Wind wind, const dvec3& u, const dvec3& c) {
    CHECK(wind_load(wind, u, c).force == wind_load(wind, u, -c).force);
    CHECK(wind_load(wind, u, c).braking == wind_load(wind, u, -c).braking);
    CHECK(wind_load(wind, u, c).force == -wind_load(wind, -u, c).force);
  });
}

TEST_CASE("there is no force in air that moves along, nor on a triangle without an area, and never NaN") {
  const Wind wind{1.0, 0.2};
  CHECK(wind_load(wind, dvec3(0.0), crossed).force == dvec3(0.0));
  CHECK(wind_load(wind, dvec3(1.0, 2.0, 3.0), dvec3(0.0)).force == dvec3(0.0));
  CHECK(wind_load(wind, dvec3(0.0), dvec3(0.0)).force == dvec3(0.0));
  for (const double small : {1e-8, 1e-40, 1e-100, 1e-160, 1e-300}) {
    for (const dvec3& u : {dvec3(0.0, small, 0.0), dvec3(1.0, 2.0, 3.0)})
      for (const dvec3& c : {small * crossed, crossed}) {
        const auto load = wind_load(wind, u, c);
        CHECK(glm::length(load.force) <= 20.0 * glm::length(u) * glm::length(c) * glm::length(u));  // not NaN
        CHECK(load.braking >= 0.0);
      }
  }
}

TEST_CASE("the force goes to 0 where the flow grazes, without a jump") {
  // |force| <= density A / 2 |u|^2 (drag + lift) |sin(angle)|, and its slope is bounded everywhere.
  const double most = 0.6 * 0.01 * 9.0 * 1.2, step = 1e-4;
  for (double angle = -3.2; angle < 3.2; angle += step) {
    const dvec3 here = wind_load({1.0, 0.2}, flow(3.0, angle), crossed).force;
    const dvec3 next = wind_load({1.0, 0.2}, flow(3.0, angle + step), crossed).force;
    REQUIRE(glm::length(here) <= most * std::abs(std::sin(angle)) * (1.0 + rounding) + 1e-300);
    REQUIRE(glm::distance(here, next) <= 2.0 * most * step);
  }
}

TEST_CASE("braking times the speed bounds the force, and along the normal too") {
  at_random([](Wind wind, const dvec3& u, const dvec3& c) {
    const auto load = wind_load(wind, u, c);
    const dvec3 n = glm::normalize(c);
    CHECK(glm::length(load.force) <= load.braking * glm::length(u) * (1.0 + rounding));
    CHECK(std::abs(glm::dot(load.force, n)) <=
          load.braking * std::abs(glm::dot(u, n)) * (1.0 + 1e-9) + 1e-12 * load.braking);
  });
}

TEST_CASE("an explicit step takes at most all of the flow's speed, and all of the force where that is less") {
  CHECK(elements::wind_share(0.001, 2.0, 3.0, 1.0) == 1.0);
  for (const double dt : {0.1, 1.0, 100.0})
    for (const double most : {elements::most_of_flow, elements::most_of_flow_predicted})
      CHECK(elements::wind_share(dt, 50.0, 1.0, most) * dt * 50.0 * 1.0 == Approx(most));
  CHECK(elements::wind_share(0.1, 0.0, 1.0, 1.0) == 1.0);  // a pin
}

TEST_CASE("gusts are velocity (1 + gust sin(2 pi frequency t)), and the largest speed is their crest") {
  const scene::Wind wind{{3.0, 0.0, -4.0}, 0.5, 0.25, 1.0, 0.2};
  CHECK(model::wind_velocity(wind, 0.0) == dvec3(3.0, 0.0, -4.0));
  CHECK(glm::distance(model::wind_velocity(wind, 1.0), dvec3(4.5, 0.0, -6.0)) < rounding);
  CHECK(glm::distance(model::wind_velocity(wind, 3.0), dvec3(1.5, 0.0, -2.0)) < rounding);
  CHECK(model::largest_wind_speed(wind) == Approx(7.5));
  CHECK(model::largest_wind_speed({{3.0, 0.0, -4.0}, 0.5, 0.0, 1.0, 0.2}) == Approx(5.0));
}

TEST_CASE("a cloth of any shape that moves with the wind feels nothing") {
  scene::Scene scene = test::sheet(6, 5);
  scene.wind = scene::Wind{{3.0, 1.0, -2.0}, 0.5, 0.5, 1.0, 0.2};
  scene.cloths[0].start = scene::Scatter{1.0, 5};
  const reference::World world = world_of(scene);
  const reference::State state = reference::at_rest(world);
  const std::vector<dvec3> along(state.position.size(), model::wind_velocity(*scene.wind, 0.7));
  for (const auto& load : reference::wind_loads(world, state.position, along, 0.7)) {
    CHECK(glm::length(load.force) < 1e-28);  // the mean of three equal velocities is rounded
    CHECK(load.braking < 1e-14);
  }
}

TEST_CASE("the load of each triangle is on its corners, a third each") {
  scene::Scene scene = test::sheet(4, 3);
  scene.wind = scene::Wind{{0.0, 5.0, 0.0}, 0.0, 0.0, 1.2, 0.2};
  const reference::World world = world_of(scene);
  const reference::State state = reference::at_rest(world);
  dvec3 sum(0.0);
  for (const auto& load : reference::wind_loads(world, state.position, state.velocity, 0.0))
    sum += load.force;
  CHECK(glm::distance(sum, dvec3(0.0, 0.6 * 1.0 * 1.2 * 25.0, 0.0)) < 1e-12);  // a square metre
}

TEST_CASE("no cloth slower than twice the wind gets more power from it than the watch for blow-ups allows") {
  scene::Scene scene = test::sheet(2, 2);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  double nearest = 0.0;
  for (int n = 0; n < 200000; ++n) {
    const double speed = 4.0;
    const dvec3 air(speed, 0.0, 0.0);
    const dvec3 u = 2.0 * speed * dvec3(number(random), number(random), number(random)), v = air - u;
    const dvec3 across(number(random), number(random), number(random));
    if (glm::length(u) > 2.0 * speed || glm::length(across) < 0.1) continue;
    const dvec3 c = 2.0 * glm::normalize(across);  // a square metre, as the sheet
    scene.wind = scene::Wind{air, 0.0, 0.0, number(random) + 1.0, number(random) + 1.0};
    const double power = glm::dot(wind_load({scene.wind->drag, scene.wind->lift}, u, c).force, v);
    const double allowed =
        0.6 * std::pow(speed, 3) * (4.0 / 27.0 * scene.wind->drag + 2.0 * scene.wind->lift);
    REQUIRE(power <= allowed);
    nearest = std::max(nearest, power / allowed);
  }
  CHECK(nearest > 0.2);  // the bound is of the power's own size
  scene.wind = scene::Wind{{4.0, 0.0, 0.0}, 0.0, 0.0, 1.0, 0.2};
  CHECK(model::largest_wind_power(*model::build(scene), scene) == Approx(0.6 * 64.0 * (4.0 / 27.0 + 0.4)));
}
