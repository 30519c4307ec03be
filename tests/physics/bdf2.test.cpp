// BDF2 on the GPU: where it may not use the step before, wind, and contact that begins. Its steps against the
// reference are in implicit_euler.test.cpp, its order in order.test.cpp.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "server/model/hold.h"
#include "server/sim/hands.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

scene::Scene swinging(Method method) {
  scene::Scene scene = swinging_cloth(method, 3 * cloth_unit);
  scene.solver.iterations = 3;
  scene.solver.tolerance = 1e-6;
  return scene;
}

double distance(const sim::State& a, const sim::State& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    const glm::dvec3 apart = glm::dvec3(a.position[i]) - glm::dvec3(b.position[i]);
    sum += glm::dot(apart, apart);
  }
  return std::sqrt(sum / static_cast<double>(a.position.size()));
}

/// How far the next step of `simulation` ends from that of implicit Euler [m], which begins anew from there.
double from_implicit_euler(sim::Simulation& simulation) {
  scene::Scene scene = simulation.scene();
  scene.solver.method = Method::implicit_euler;
  const auto other = test::simulation(scene);
  other->restore(simulation.read_state(), simulation.time(), simulation.step_index());
  other->step(1);
  simulation.step(1);
  return distance(simulation.read_state(), other->read_state());
}

/// What two solves to 1e-6 may differ by [m]: the step's way is some millimetres.
constexpr double same = 1e-6;

}  // namespace

TEST_CASE("BDF2's first step is implicit Euler's, to the bit, and its second one is not") {
  const auto context = test::context();
  const auto first = test::simulation(swinging(Method::bdf2)),
             second = test::simulation(swinging(Method::implicit_euler));
  first->step(1);
  second->step(1);
  CHECK(sim::state_hash(first->read_state()) == sim::state_hash(second->read_state()));
  CHECK(from_implicit_euler(*first) > 20 * same);
}

TEST_CASE("BDF2 begins anew, by implicit Euler, after another dt, a hand, a state from outside and a reset") {
  const auto context = test::context();
  const auto simulation = test::simulation(swinging(Method::bdf2));
  simulation->step(20);
  CHECK(from_implicit_euler(*simulation) > 20 * same);

  scene::Scene shorter = simulation->scene();
  shorter.solver.dt *= 0.5;
  REQUIRE(simulation->change(shorter));
  CHECK(from_implicit_euler(*simulation) < same);
  CHECK(from_implicit_euler(*simulation) > 10 * same);

  simulation->restore(simulation->read_state(), simulation->time(), simulation->step_index());
  CHECK(from_implicit_euler(*simulation) < same);
  simulation->step(2);

  const model::Hold hold =
      model::hold_on(simulation->model(), simulation->scene(), 8 * 17 + 8, simulation->read_state().position);
  REQUIRE(simulation->set_hands({{std::make_shared<const model::Hold>(hold), glm::dvec3(0.2, -0.2, 0.2)}}));
  simulation->step(3);
  REQUIRE(simulation->set_hands({}));
  CHECK(from_implicit_euler(*simulation) < same);
  CHECK(from_implicit_euler(*simulation) > 10 * same);

  simulation->reset();
  const auto fresh = test::simulation(simulation->scene());
  simulation->step(5);
  fresh->step(5);
  CHECK(sim::state_hash(simulation->read_state()) == sim::state_hash(fresh->read_state()));
}

TEST_CASE(
    "a change of dt and back within BDF2's run leaves no trace, and kept steps follow again to the bit") {
  const auto context = test::context();
  const auto simulation = test::simulation(swinging(Method::bdf2)),
             other = test::simulation(swinging(Method::bdf2));
  simulation->step(10);
  other->step(10);
  const scene::Scene scene = simulation->scene();
  scene::Scene shorter = scene;
  shorter.solver.dt *= 0.5;
  REQUIRE(simulation->change(shorter));
  REQUIRE(simulation->change(scene));
  simulation->keep_state();
  simulation->step(10);
  other->step(10);
  const std::uint64_t expected = sim::state_hash(other->read_state());
  CHECK(sim::state_hash(simulation->read_state()) == expected);
  REQUIRE(simulation->go_to_kept(10, scene));
  simulation->step(10);
  CHECK(sim::state_hash(simulation->read_state()) == expected);
}

TEST_CASE("a sheet that the wind brakes falls by BDF2 with order 2") {
  const auto context = test::context();
  for (const Side side : sides) {
    std::vector<double> height;
    for (const int steps : {20, 40, 80}) {
      scene::Scene scene = swinging_cloth(Method::bdf2, 0.2 / steps);
      scene.cloths[0].mesh = scene::Grid{3, 3, 0.2, 0.2};
      scene.cloths[0].pins.clear();
      scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.1};
      scene.wind = scene::Wind{};
      scene.solver.tolerance = 1e-7;
      Stepped stepped(side, scene);
      stepped.step(steps);
      height.push_back(stepped.state().position[4].y);
    }
    const double order = std::log2((height[0] - height[1]) / (height[1] - height[2]));
    INFO(name(side) << ": " << height[0] << ", " << height[1] << ", " << height[2] << " m, order " << order);
    CHECK(order == Approx(2.0).margin(0.4));  // the next order is 3; of the wind at the step's start, 1
  }
}

TEST_CASE("a sheet that lands on a floor by BDF2 stays there: what is stopped comes back by no formula") {
  const auto context = test::context();
  for (const bool surfaces : {false, true}) {
    scene::Scene scene = swinging_cloth(Method::bdf2, 1.0 / 60.0);
    scene.cloths[0].mesh = scene::Grid{5, 5, 0.2, 0.2};
    scene.cloths[0].pins.clear();
    scene.cloths[0].transform.translate = {0.0, 0.3, 0.0};
    scene.colliders.emplace_back().shape = scene::Plane{{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    if (surfaces) scene.self_collision = scene::SelfCollision{0.005, 0.2, scene::ContactKind::surface};
    const auto simulation = test::simulation(scene);
    const double speed = std::sqrt(2.0 * 9.81 * 0.3);
    double upward = 0.0;
    for (int n = 0; n < 60; ++n) {
      simulation->step(1);
      double mean = 0.0;
      for (const glm::vec3& v : simulation->read_state().velocity) mean += static_cast<double>(v.y) / 25.0;
      upward = std::max(upward, mean);
    }
    INFO((surfaces ? "surfaces" : "vertices") << ": " << upward << " m/s of " << speed << " m/s");
    // With the formula through the impact the derivative gives back half of the speed, and V_0 a third. What
    // contact's spring had taken up in the step that met it may come back: less than a step of gravity.
    CHECK(upward < 9.81 / 60.0);
  }
}
