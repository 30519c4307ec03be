// Wind on whole cloths, on the GPU under every method and in the reference.
#include <algorithm>
#include <cmath>

#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/methods.h"
#include "tests/physics/stage.h"
#include "tests/sides.h"

using namespace clothlab;
using test::Side;
using test::Stepped;

namespace {

/// A free sheet of a square metre that lies flat, of so many kg/m^2, in wind.
scene::Scene sheet_in(const scene::Wind& wind, double density, scene::Method method, double dt) {
  scene::Scene scene = test::sheet(5, 4);
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, density};
  // Elements stable in a step of 1/60 s: k dt^2 is 1/50 of a vertex's mass.
  const double k = 72.0 * density / 20.0;
  scene.cloths[0].material = scene::Springs{k, k, 0.0, 0.02 * k};
  scene.wind = wind;
  scene.solver = {.method = method, .dt = dt};
  return scene;
}

double fastest(const std::vector<glm::dvec3>& velocity) {
  double most = 0.0;
  for (const glm::dvec3& v : velocity) most = std::max(most, glm::length(v));
  return most;
}

/// A hung sheet that a gusting wind catches from the side.
scene::Scene billowing(scene::Method method, double dt) {
  scene::Scene scene = test::sheet(7, 6);
  scene.cloths[0].mesh = scene::Grid{7, 6, 0.6, 0.5};
  scene.cloths[0].transform.rotate = {70.0, 0.0, 0.0};
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.15};
  scene.cloths[0].material = scene::Springs{20.0, 10.0, 1.0, 0.01};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}},
                          {scene::AtCorner{6, 0}, scene::Oscillate{{0.0, 0.0, 1.0}, 0.1, 1.0}}};
  scene.wind = scene::Wind{{3.0, 0.5, 4.0}, 0.6, 2.0, 1.1, 0.4};
  scene.air_drag = 0.3;
  scene.solver = {.method = method, .dt = dt, .iterations = 20, .tolerance = 1e-7};
  return scene;
}

}  // namespace

TEST_CASE("a flat sheet falls through air at rest as its closed form says, under every method") {
  // Flat, every vertex has the same force over mass: v' = g - r drag v^2 / (2 density). So v = v_t tanh(g t /
  // v_t) and the drop is v_t^2 / g ln cosh(g t / v_t), with v_t = sqrt(2 density g / (r drag)).
  const auto context = test::context();
  const double density = 0.08, drag = 1.25, g = 9.8, t = 1.0;
  const double v_t = std::sqrt(2.0 * density * g / (1.2 * drag));
  REQUIRE(g * t / v_t > 9.0);  // then the speed is within 1e-7 of v_t
  for (const Side side : test::sides)
    for (const scene::Method method : test::tried_of(scene::methods)) {
      const bool long_step = scene::any_step_is_stable(method) && scene::facts(method).order == 1;
      const int steps = long_step ? 60 : 500;
      scene::Scene scene = sheet_in({{0.0, 0.0, 0.0}, 0.0, 0.0, drag, 0.2}, density, method, t / steps);
      Stepped stepped(side, scene);
      stepped.step(steps);
      const reference::State end = stepped.state();
      INFO(test::name(side) << ", " << scene::name(method));
      // The steady speed is a fixed point of every method; float32 rounds it once a step.
      for (const glm::dvec3& v : end.velocity) CHECK(glm::distance(v, {0.0, -v_t, 0.0}) < v_t * 1e-4);
      // A method of order 1 is off by up to a step of the fall; 2 and 4 by less.
      const double drop = v_t * v_t / g * std::log(std::cosh(g * t / v_t));
      const double allowed = scene::facts(method).order == 1 ? v_t * t / steps : 2e-5;
      CHECK(std::abs(1.0 - end.position[7].y - drop) < allowed);
    }
}

TEST_CASE(
    "a sheet a thousand times too light is taken along by the wind in long steps and does not overtake it") {
  const auto context = test::context();
  const glm::dvec3 air(4.0, 3.0, 0.0);
  for (const Side side : test::sides)
    for (const scene::Method method : test::tried_of(scene::methods))
      for (const double lift : {0.0, 0.5, 3.0}) {
        scene::Scene scene = sheet_in({air, 0.0, 0.0, 1.0, lift}, 1e-4, method, 1.0 / 60);
        scene.gravity = glm::dvec3(0.0);
        scene.solver.iterations = 1;
        // What is left of y' = -k (a - y) after a step of Euler's and one of BDF2 is
        // (4 / (1 + k dt) - 1) / (3 + 2 k dt) of the start, which is -0.03 at most. Wind is not linear.
        const double beyond = method == scene::Method::bdf2 ? 0.05 : 1e-5;
        Stepped stepped(side, scene);
        INFO(test::name(side) << ", " << scene::name(method) << ", lift " << lift);
        for (int n = 0; n < 40; ++n) {
          stepped.step(1);
          const reference::State state = stepped.state();
          REQUIRE(fastest(state.velocity) <= glm::length(air) * (1.0 + beyond));
        }
        // Every step but of a flow that grazes takes a good part of what is left across the sheet.
        for (const glm::dvec3& v : stepped.state().velocity) CHECK(v.y > 0.98 * air.y);
      }
}

TEST_CASE("a held cloth feels the whole wind in long steps under implicit Euler and VBD, a part under XPBD") {
  // Of 20 g/m^2: the wind could give it six times its own speed in a step of 1/60 s.
  const auto context = test::context();
  const auto bulge = [](Side side, scene::Method method, double dt) {
    scene::Scene scene = test::sheet(5, 3);
    scene.gravity = glm::dvec3(0.0);
    scene.cloths[0].mesh = scene::Grid{5, 3, 0.4, 0.2};
    scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.02};
    scene.cloths[0].material = scene::Springs{200.0, 100.0, 0.0, 0.05};
    scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}},
                            {scene::AtEdge{scene::AtEdge::Line::row, 2}, {}}};
    scene.wind = scene::Wind{{0.0, 10.0, 0.0}, 0.0, 0.0, 1.0, 0.2};
    scene.solver = {.method = method, .dt = dt, .iterations = 60, .tolerance = 1e-6};
    Stepped stepped(side, scene);
    stepped.step(static_cast<int>(std::lround(2.0 / dt)));
    return stepped.state().position[7].y - 1.0;
  };
  const double whole = bulge(Side::reference, scene::Method::symplectic_euler, 1e-4);
  REQUIRE(whole > 0.01);
  for (const Side side : test::sides) {
    INFO(test::name(side) << ": " << whole << " m in short steps");
    CHECK(bulge(side, scene::Method::implicit_euler, 1.0 / 60) == Approx(whole).epsilon(1e-3));
    CHECK(bulge(side, scene::Method::vbd, 1.0 / 60) == Approx(whole).epsilon(1e-3));
    CHECK(bulge(side, scene::Method::xpbd, 1.0 / 600) == Approx(whole).epsilon(1e-3));
    CHECK(bulge(side, scene::Method::xpbd, 1.0 / 60) < 0.8 * whole);
  }
}

TEST_CASE("a sheet that moves with the wind goes on as if there were no air") {
  const auto context = test::context();
  for (const scene::Method method : test::tried_of(scene::methods)) {
    scene::Scene scene = sheet_in({{2.0, -1.0, 0.5}, 0.0, 0.0, 1.0, 0.2}, 0.1, method, 0.005);
    scene.gravity = glm::dvec3(0.0);
    scene.cloths[0].transform.rotate = {30.0, 20.0, 50.0};
    const auto simulation = test::simulation(scene);
    sim::State state = simulation->read_state();
    std::fill(state.velocity.begin(), state.velocity.end(), glm::vec3(2.0f, -1.0f, 0.5f));
    simulation->restore(state, 0.0, 0);
    simulation->step(200);
    INFO(scene::name(method));
    // 200 steps, whose springs feel the rounding of coordinates of up to 3 m.
    for (const glm::vec3& v : simulation->read_state().velocity)
      CHECK(glm::distance(v, glm::vec3(2.0f, -1.0f, 0.5f)) < 1e-3f);
  }
}

TEST_CASE("in a gusting wind the GPU is where the double-precision reference is, under every method") {
  const auto context = test::context();
  for (const scene::Method method : test::tried_of(scene::methods)) {
    const int steps = 60;
    scene::Scene scene = billowing(method, scene::any_step_is_stable(method) ? 0.004 : 0.002);
    if (method == scene::Method::explicit_euler) scene.cloths[0].springs().damping = 0.05;
    Stepped gpu(Side::gpu, scene), exact(Side::reference, scene);
    scene.wind.reset();
    Stepped calm(Side::reference, scene);
    for (Stepped* each : {&gpu, &exact, &calm}) each->step(steps);
    const double error = reference::rms_distance(gpu.state().position, exact.state().position);
    const double blown = reference::rms_distance(calm.state().position, exact.state().position);
    INFO(scene::name(method) << ": off by " << error << " m; the wind moved it by " << blown << " m");
    CHECK(blown > 0.01);
    // Rounding of 1e-7 m a step, 60 steps, and what implicit Euler's solver leaves at 1e-7 of the speed.
    CHECK(error < 1e-5);
    CHECK(error > 0.0);
  }
}

TEST_CASE("a single Newton step in wind is the reference's: the wind is part of the system that is solved") {
  const auto context = test::context();
  scene::Scene scene = billowing(scene::Method::implicit_euler, 0.004);
  scene.cloths[0].mass.value = 0.02;
  scene.solver.iterations = 1;
  const auto simulation = test::simulation(scene);
  const reference::World world = world_of(scene);
  reference::State exact = reference::at_rest(world);
  for (int n = 0; n < 20; ++n) reference::limited_newton_step(world, exact);
  simulation->step(20);
  // 20 steps of a cloth so light that the rounding of a spring's force, 1e-6 N, moves a vertex by 5e-8 m in
  // one.
  CHECK(reference::rms_distance(in_double(simulation->read_state(), 20).position, exact.position) < 1e-5);
}

TEST_CASE("each method keeps its order in a gusting wind") {
  // The reference, against RK4 with steps a sixteenth as long as the finest: what float32 adds is no matter
  // of wind. No triangle turns edge-on within this time: there the law's second derivative jumps.
  const double time = 0.08;
  const auto position = [&](scene::Method method, int steps) {
    scene::Scene scene = billowing(method, time / steps);
    scene.wind->velocity = {1.0, 0.5, 6.0};
    scene.cloths[0].springs().damping = 0.02;
    scene.solver.iterations = 60;
    Stepped stepped(Side::reference, scene);
    stepped.step(steps);
    return stepped.state().position;
  };
  const auto truth = position(scene::Method::rk4, 2048);
  for (const scene::Method method : test::tried_of(scene::methods)) {
    if (method == scene::Method::pbd) continue;  // its stiffness depends on dt
    const int coarse = scene::facts(method).order == 4 ? 16 : 64;
    const double first = reference::rms_distance(position(method, coarse), truth),
                 last = reference::rms_distance(position(method, 4 * coarse), truth);
    INFO(scene::name(method) << ": " << first << " m, " << last << " m");
    CHECK(std::abs(std::log2(first / last) / 2.0 - scene::facts(method).order) < 0.15);
  }
}

TEST_CASE("the same wind gives the same bits, however the steps are grouped, and other bits than none") {
  const auto context = test::context();
  for (const scene::Method method : test::tried_of(scene::methods)) {
    scene::Scene scene = billowing(method, 0.002);
    scene.solver.iterations = 4;
    const auto hash = [&](const std::vector<std::uint32_t>& batches) {
      const auto simulation = test::simulation(scene);
      for (const std::uint32_t batch : batches) simulation->step(batch);
      return sim::state_hash(simulation->read_state());
    };
    INFO(scene::name(method));
    const std::uint64_t expected = hash({70});
    CHECK(hash({70}) == expected);
    CHECK(hash({1, 36, 33}) == expected);
    scene.wind->gust_frequency *= 1.001;
    CHECK(hash({70}) != expected);
    scene.wind.reset();
    CHECK(hash({70}) != expected);
  }
}

TEST_CASE("wind comes and goes with new kernels, changes as a number, and is listed as a term") {
  const auto context = test::context();
  scene::Scene scene = billowing(scene::Method::symplectic_euler, 0.002);
  const scene::Wind wind = *scene.wind;
  scene.wind.reset();
  const auto simulation = test::simulation(scene);
  const auto skipped = [&] {
    for (const sim::Simulation::Part& part : simulation->parts())
      if (part.name == "wind") return part.skipped;
    return std::string("not listed");
  };
  CHECK(skipped() == "wind is null");
  simulation->step(20);
  const double time = simulation->time();
  scene.wind = wind;
  CHECK(*simulation->change(scene) == sim::ChangeDepth::kernel);
  CHECK(simulation->time() == time);
  CHECK(skipped().empty());
  scene.wind->velocity.x = -5.0;
  CHECK(*simulation->change(scene) == sim::ChangeDepth::uniform);
  scene.wind->gust = 0.0;
  CHECK(*simulation->change(scene) == sim::ChangeDepth::uniform);
  const float before = simulation->read_state().position[40].x;
  simulation->step(100);
  CHECK(simulation->read_state().position[40].x < before - 0.02f);
  scene.wind.reset();
  CHECK(*simulation->change(scene) == sim::ChangeDepth::kernel);
}
