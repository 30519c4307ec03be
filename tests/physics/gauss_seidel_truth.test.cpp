// PBD, XPBD and VBD on the GPU against closed results: implicit Euler's step, a hanging strip's closed form,
// free fall, and the same bits in every run.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <tuple>

#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/physics/rounding.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

constexpr std::array methods{Method::pbd, Method::xpbd, Method::vbd};

/// Places after one step, and after four.
std::array<std::vector<glm::dvec3>, 2> after_one_and_four(Side side, scene::Scene scene, Method method,
                                                          int iterations) {
  scene.solver.method = method;
  scene.solver.iterations = iterations;
  Stepped stepped(side, scene);
  stepped.step(1);
  const std::vector<glm::dvec3> one = stepped.state().position;
  stepped.step(3);
  return {one, stepped.state().position};
}

/// The seed's cloth with pins that stand still, without colliders and self-collision.
scene::Scene seed_cloth(double dt) {
  scene::Scene scene = test::seed();
  for (scene::Pin& pin : scene.cloths[0].pins) pin.motion = {};
  scene.colliders.clear();
  scene.self_collision.reset();
  scene.solver.dt = dt;
  return scene;
}

/// Of the state after so many steps by one form of the sweeps.
std::uint64_t hash_of_form(const char* form, const scene::Scene& scene, int steps) {
  setenv("CLOTHLAB_SWEEPS", form, 1);
  const auto simulation = test::simulation(scene);
  unsetenv("CLOTHLAB_SWEEPS");
  simulation->step(static_cast<std::uint32_t>(steps));
  return sim::state_hash(simulation->read_state());
}

}  // namespace

TEST_CASE(
    "with many iterations XPBD and VBD agree with implicit Euler on the GPU to 1e-5 of the cloth's size") {
  const auto context = test::context();
  // More sweeps than one kernel of software OpenGL can loop: such steps take several dispatches.
  struct Case {
    const char* what;
    scene::Scene scene;
    double size;
    int iterations;
    Side side = Side::gpu;  ///< side that runs implicit Euler
  };
  scene::Scene damped = swinging_cloth(Method::implicit_euler, 2 * cloth_unit);
  damped.cloths[0].springs().damping = 0.01;
  // (With such strong damping the GPU's Newton steps stop 4e-5 m short of the reference, which both other
  // methods reach.)
  damped.air_drag = 0.5;
  damped.cloths[0].pins[0].motion = scene::Oscillate{{0.0, 0.0, 1.0}, 0.02, 5.0};
  Part part(2);
  for (const Case& one :
       {Case{"swinging cloth, 2 u", swinging_cloth(Method::implicit_euler, 2 * cloth_unit), 0.5, 100},
        Case{"damped, in air, shaken, 2 u", damped, 0.5, 200, Side::reference},
        Case{"the seed's cloth, 2 ms", seed_cloth(2e-3), 1.0, 100},
        Case{"the seed's cloth, 5 ms", seed_cloth(5e-3), 1.0, 300}}) {
    if (part.leaves_out()) continue;
    scene::Scene scene = one.scene;
    scene.solver.tolerance = 1e-7;
    constexpr int newton_steps = 20;
    const auto exact = after_one_and_four(one.side, scene, Method::implicit_euler, newton_steps);
    for (const Method method : {Method::xpbd, Method::vbd}) {
      const auto found = after_one_and_four(Side::gpu, scene, method, one.iterations);
      for (const std::size_t later : {0u, 1u}) {
        const double off = reference::rms_distance(found[later], exact[later]);
        INFO(one.what << ", " << scene::name(method) << (later ? ", 4 steps: " : ", 1 step: ") << off
                      << " m");
        CHECK(off < 1e-5 * one.size);
      }
    }
  }
}

TEST_CASE(
    "a strip hung under XPBD on the GPU stretches as its closed form says within 1 %, for 1 to 100 "
    "iterations") {
  const auto context = test::context();
  constexpr int links = 16;
  constexpr double k = 40.0, mass = 2e-4, g = 9.8;
  const double unit = std::sqrt(mass / k), air = 3.14159 / links / unit;
  const double exact = mass * g * links * (links + 1) / (2 * k);
  const auto stretch = [&](Method method, double dt, int iterations, double damping = 0.0) {
    scene::Scene scene = hung_strip(method, dt, 5, links + 1, 0.1, 0.4);
    scene.gravity = {0.0, 0.0, g};
    scene.cloths[0].mass.value = mass;
    scene.cloths[0].material = scene::Springs{k, 0.0, 0.0, damping};
    scene.air_drag = air;  // the slowest mode dies away without swinging: e^-12 of it is left
    scene.solver.iterations = iterations;
    Stepped gpu(Side::gpu, scene);
    gpu.step(static_cast<int>(24.0 / air / dt));
    return gpu.state().position[5 * links + 2].z - 0.4;
  };
  // With one iteration the springs of the first colour are 2 (k dt^2 + c dt) / m too long, c their damping:
  // nearly (k dt^2 + c dt) / m on the whole, as tests/unit/hanging_chain.test.cpp derives exactly.
  for (const int iterations : {1, 10, 100}) {
    const double off = stretch(Method::xpbd, 0.1 * unit, iterations) / exact - 1.0;
    INFO(iterations << " iterations: off by " << off);
    CHECK(std::abs(off) < 0.01);
  }
  CHECK(stretch(Method::xpbd, 0.1 * unit, 1, 0.01) / exact - 1.0 == Approx(0.019).epsilon(0.1));
  // At a step ten times as long, one iteration is off by all of the stretch, a hundred are right; PBD's are
  // not (tests/unit/hanging_chain.test.cpp has its law).
  CHECK(std::abs(stretch(Method::xpbd, unit, 1) / exact - 1.0) > 0.5);
  CHECK(std::abs(stretch(Method::xpbd, unit, 100) / exact - 1.0) < 0.01);
  CHECK(std::abs(stretch(Method::vbd, unit, 100) / exact - 1.0) < 0.01);
  CHECK(std::abs(stretch(Method::pbd, unit, 100) / exact - 1.0) > 0.5);
}

TEST_CASE("a light sheet falls flat on the GPU under PBD, XPBD and VBD, in air and without, at any step") {
  const auto context = test::context();
  for (const Method method : methods) {
    for (const double dt : {1e-3, 1.0 / 60.0, 1.0 / 30.0}) {
      for (const double air : {0.0, 1.0}) {
        scene::Scene scene = test::sheet(25, 25);
        scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.15};
        scene.air_drag = air;
        scene.solver = {.method = method, .dt = dt, .iterations = 4};
        Stepped gpu(Side::gpu, scene);
        const int steps = static_cast<int>(0.5 / dt);
        gpu.step(steps);
        const auto state = gpu.state();
        double y = 0.0, v = 0.0, most = 0.0;
        for (int n = 0; n < steps; ++n) {
          v = (v - 9.8 * dt) / (1.0 + dt * air);
          y += dt * v;
        }
        for (std::size_t i = 0; i < state.position.size(); ++i)
          most = std::max(most, glm::distance(state.position[i],
                                              gpu.world().model.rest_position[i] + glm::dvec3(0, y, 0)));
        INFO(scene::name(method) << ", dt " << dt << " s, air " << air << ": off by " << most << " m");
        // Each step rounds a place of up to 2 m and a displacement; what float32 loses of 5 m/s moves the
        // vertex in each later step.
        CHECK(most < 2e-5);
      }
    }
  }
}

TEST_CASE("PBD, XPBD and VBD end in the same bits twice, however the steps are grouped, with contacts") {
  const auto context = test::threaded_context();
  for (const Method method : methods) {
    scene::Scene scene = test::seed();
    scene.solver = {.method = method, .dt = 2e-3, .iterations = 3};
    const auto hash = [&](const std::vector<std::uint32_t>& batches) {
      const auto simulation = test::simulation(scene);
      for (const std::uint32_t batch : batches) simulation->step(batch);
      return sim::state_hash(simulation->read_state());
    };
    const std::uint64_t expected = hash({240});  // it lies on the ball from step 90 on
    INFO(scene::name(method));
    CHECK(hash({240}) == expected);
    CHECK(hash({1, 99, 33, 107}) == expected);
    scene.cloths[0].mass.value *= 1.0001;
    CHECK(hash({240}) != expected);  // the hash differs after other steps
  }
}

TEST_CASE("one work group and a dispatch a colour come to the same state, PBD, XPBD and VBD, with contacts") {
  const auto context = test::context();
  Part part(2);
  for (const Method method : methods) {
    // Software OpenGL ends a kernel's loops after 65535 turns: many sweeps need more lanes.
    for (const auto& [iterations, steps, self] : {std::tuple{3, 200, true}, {64, 8, true}, {256, 3, false}}) {
      if (part.leaves_out()) continue;  // each method, and each number of iterations
      scene::Scene scene = test::seed();
      if (!self) scene.self_collision.reset();
      scene.solver = {.method = method, .dt = 2e-3, .iterations = iterations};
      INFO(scene::name(method) << ", " << iterations << " iterations");
      CHECK(hash_of_form("one_group", scene, steps) == hash_of_form("dispatches", scene, steps));
    }
  }
}

TEST_CASE("both forms of the sweeps round alike in a free heap, where forces are large") {
  const auto context = test::context();
  scene::Scene heap = test::sheet(15, 15);
  heap.cloths[0].start = scene::Scatter{.size = 0.5, .seed = 3};
  for (const bool meets_itself : {false, true})
    for (const Method method : methods) {
      if (meets_itself) heap.self_collision = scene::SelfCollision{0.05, 0.1};
      heap.solver = {.method = method, .dt = 1e-3, .iterations = 10};
      INFO(scene::name(method) << (meets_itself ? ", it meets itself" : ""));
      // Forces are largest at the start, and a bit that differs never comes right again.
      CHECK(hash_of_form("one_group", heap, 80) == hash_of_form("dispatches", heap, 80));
    }
}
