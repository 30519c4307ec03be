// The strain limit of finite elements: warp and weft of every triangle after a step of every method.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/model/stability.h"
#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/curved.h"
#include "tests/methods.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"
#include "tests/stretch.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// A strip of 0.1 m x 0.3 m that hangs by a short side. Its weight of 15 N a metre of width would stretch it
/// by some 30 %.
scene::Scene strip(Method method, std::optional<scene::StrainLimit> limit, double grain = 0.0) {
  scene::Scene scene = bare_scene(method, 1e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.air_drag = 3.0;
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{5, 13, 0.1, 0.3};
  cloth.transform.rotate = {90.0, 0.0, 0.0};
  cloth.mass = {scene::Mass::Kind::area_density, 5.0};
  cloth.material = scene::Fem{50.0, 50.0, 0.3, 20.0, {1e-5, 1e-5, std::nullopt}, 2e-3, grain, limit};
  cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
  scene.cloths = {cloth};
  if (scene::iterates(method)) scene.solver.iterations = 10;
  if (!scene::any_step_is_stable(method))
    scene.solver.dt = std::min(1e-3, 0.4 * model::dt_limit(*model::build(scene), scene));
  return scene;
}

/// Length over length at rest, less 1, of the threads along warp and weft that stretch most; of triangles
/// that are not pinned as a whole.
struct Largest {
  double warp = -1.0, weft = -1.0;
};
Largest largest_threads(const reference::World& world, const std::vector<dvec3>& x) {
  Largest most;
  for (const auto& triangle : world.model.elements.of<elements::Membrane>()) {
    const auto& corners = triangle.vertices;
    if (std::all_of(corners.begin(), corners.end(), [&](auto vertex) { return world.pinned(vertex); }))
      continue;
    const elements::Gradient f = elements::gradient(triangle.law, model::edges(triangle, 0, x));
    most.warp = std::max(most.warp, glm::length(f.warp) - 1.0);
    most.weft = std::max(most.weft, glm::length(f.weft) - 1.0);
  }
  return most;
}

/// Roundings of two corners' places, about 0.3 m, over a cell of 0.025 m.
constexpr double rounding = 4 * 0x1p-24 * 0.3 / 0.025;

}  // namespace

TEST_CASE(
    "no thread of a hanging strip is longer than the limit after a step of any method, on and off the "
    "grain, but for steps that are told of") {
  const auto context = test::context();
  constexpr double limit = 0.05;
  for (const Method method : tried_of(sheet_methods()))
    for (const double grain : {0.0, 30.0}) {
      const scene::Scene scene = strip(method, limit, grain);
      Stepped stepped(Side::gpu, scene);
      INFO(scene::name(method) << ", grain " << grain);
      const int steps = static_cast<int>(0.36 / scene.solver.dt);
      Largest most;
      for (int look = 0; look < 12; ++look) {
        stepped.step(steps / 12 - 1);
        const std::uint64_t told = stepped.beyond_limit();
        stepped.step(1);
        most = largest_threads(stepped.world(), stepped.state().position);
        if (stepped.beyond_limit() == told) CHECK(std::max(most.warp, most.weft) <= limit + rounding);
      }
      // As the strip springs back into its limit, its sweeps may not end in time, but in few steps.
      CHECK(100 * stepped.beyond_limit() <= static_cast<std::uint64_t>(steps));
      // It hangs at its limit, and would hang far beyond.
      CHECK(std::max(most.warp, most.weft) > 0.95 * limit);
      // (The strip's weight does that whatever the method.)
      if (method != Method::symplectic_euler) continue;
      Stepped free(Side::gpu, strip(method, std::nullopt, grain));
      free.step(steps);
      const Largest without = largest_threads(free.world(), free.state().position);
      CHECK(std::max(without.warp, without.weft) > 2.0 * limit);
    }
}

TEST_CASE("warp and weft each keep to their own limit") {
  const auto context = test::context();
  for (const Side side : sides)
    for (const double grain : {0.0, 90.0}) {  // the strip hangs along its weft, then along its warp
      Stepped stepped(side, strip(Method::symplectic_euler, scene::StrainLimit(0.02, 0.1), grain));
      stepped.step(600);
      const Largest most = largest_threads(stepped.world(), stepped.state().position);
      INFO(name(side) << ", grain " << grain << ": " << most.warp << ", " << most.weft);
      CHECK(most.warp <= 0.02 + rounding);
      CHECK(most.weft <= 0.1 + rounding);
      CHECK((grain == 0.0 ? most.weft / 0.1 : most.warp / 0.02) > 0.95);
    }
}

TEST_CASE("a strip at its strain limit hangs on the GPU where it does in the reference") {
  const auto context = test::context();
  for (const Method method : {Method::symplectic_euler, Method::implicit_euler, Method::vbd})
    for (const double grain : {0.0, 30.0}) {
      const scene::Scene scene = strip(method, 0.05, grain);
      Stepped gpu(Side::gpu, scene), reference(Side::reference, scene);
      const int steps = static_cast<int>(0.2 / scene.solver.dt);  // it falls to its limit in 0.06 s
      gpu.step(steps);
      reference.step(steps);
      const double apart = reference::rms_distance(gpu.state().position, reference.state().position);
      INFO(scene::name(method) << ", grain " << grain << ": " << apart << " m");
      // The GPU pulls threads to 2 % less than the limit: 3e-4 m over 0.3 m; sweeps in another order share
      // what they correct in another way, by about as much.
      CHECK(apart < 1e-3);
    }
}

TEST_CASE(
    "the strain limit keeps the momenta of a free sheet whose threads are all too long, step after step") {
  const auto context = test::context();
  scene::Scene scene = bare_scene(Method::symplectic_euler, 1e-3);
  scene.cloths = {curved_cloth(rectangle(8, 8, 0.2, 0.2, 0.25),
                               {5.0, 5.0, 0.3, 2.0, {1e-6, 1e-6, std::nullopt}, 0.0, 20.0, 0.03})};
  // A little too long: the limit makes it spring together at some 0.3 m/s, far below the speed of its waves.
  scene.cloths[0].start = scene::Stretch{{1.034, 1.0, 1.033}};
  for (const Side side : sides) {
    Stepped stepped(side, scene);
    stepped.step(100);
    const reference::State state = stepped.state();
    dvec3 linear(0.0), angular(0.0);
    double scale = 0.0;
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const dvec3 p = stepped.world().model.mass[i] * state.velocity[i];
      linear += p;
      angular += glm::cross(state.position[i] - dvec3(0.1, 0.0, 0.1), p);
      scale += glm::length(p);
    }
    INFO(name(side) << ": " << glm::length(linear) / scale << ", " << glm::length(angular) / (0.1 * scale));
    CHECK(scale > 1e-3 * 0.2 * 0.04);
    CHECK(glm::length(linear) < 1e-5 * scale);
    // The reference pulls along the thread's present direction: its turn is off by the corrections' share of
    // the arm. The GPU pulls along the direction at the step's start.
    CHECK(glm::length(angular) < (side == Side::gpu ? 1e-4 : 1e-2) * 0.1 * scale);
  }
}

TEST_CASE("springs and finite elements side by side each keep to their strain limits") {
  const auto context = test::context();
  scene::Scene scene = strip(Method::verlet, 0.05, 30.0);
  scene::Cloth springs = scene.cloths[0];
  springs.transform.translate = {0.5, 0.0, 0.0};
  springs.material = scene::Springs{50.0, 20.0, 0.0, 0.0, 0.1};
  scene.cloths.push_back(springs);
  springs.transform.translate = {1.0, 0.0, 0.0};
  springs.springs().strain_limit.reset();
  scene.cloths.push_back(springs);
  const auto simulation = test::simulation(scene);
  const reference::World world = *reference::make_world(scene, 0.0);
  simulation->step(400);
  const sim::State state = simulation->read_state();
  const Largest most = largest_threads(world, {state.position.begin(), state.position.end()});
  CHECK(std::max(most.warp, most.weft) <= 0.05 + 4 * rounding);
  double limited = 0.0, free = 0.0;
  for (const model::Spring& spring : world.model.springs()) {
    const auto [a, b] = spring.vertices;
    const double stretch =
        glm::distance(dvec3(state.position[a]), dvec3(state.position[b])) / spring.law.rest_length - 1.0;
    double& of = world.model.vertex_cloth[a] == 1 ? limited : free;
    of = std::max(of, stretch);
  }
  CHECK(limited <= 0.1 + 4 * rounding);
  CHECK(limited > 0.09);
  CHECK(free > 0.15);
}

TEST_CASE(
    "a limit of warp and weft that nothing reaches changes no bit, and one that acts is the same twice") {
  const auto context = test::context();
  const auto hash = [](std::optional<scene::StrainLimit> limit) {
    const auto simulation = test::simulation(strip(Method::symplectic_euler, limit, 30.0));
    simulation->step(200);
    return sim::state_hash(simulation->read_state());
  };
  CHECK(hash(10.0) == hash(std::nullopt));
  CHECK(hash(0.05) == hash(0.05));
  CHECK(hash(0.05) != hash(std::nullopt));
}

TEST_CASE("limit and grain may change while a sheet hangs at its limit") {
  const auto context = test::context();
  Stepped stepped(Side::gpu, strip(Method::symplectic_euler, 0.1));
  stepped.step(300);
  stepped.change(strip(Method::symplectic_euler, 0.04, 45.0));
  // The sheet is at 0.1 and may take more than one step to get to 0.04.
  stepped.step(50);
  const Largest most = largest_threads(stepped.world(), stepped.state().position);
  CHECK(std::max(most.warp, most.weft) <= 0.04 + rounding);
}

TEST_CASE("a limit of threads that the pins forbid is reported, and nothing is lost to infinity") {
  const auto context = test::context();
  scene::Scene scene = strip(Method::symplectic_euler, 0.05);
  scene.cloths[0].pins.push_back(
      {scene::AtEdge{scene::AtEdge::Line::row, 12}, scene::Linear{{0.0, -1.0, 0.0}}});
  const auto simulation = test::simulation(scene);
  simulation->step(100);  // 0.1 m beyond 0.3 m
  CHECK(simulation->strain_limit_work().unconverged > 10);
  CHECK(simulation->diagnose().finite);
}
