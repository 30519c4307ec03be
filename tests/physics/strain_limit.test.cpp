// Provot's strain limit after a step of every method.
#include <cmath>
#include <tuple>

#include "server/scene/method.h"
#include "tests/methods.h"
#include "tests/scenes.h"
#include "tests/stretch.h"

using namespace clothlab;

namespace {

/// The seed's cloth, 0.1 kg per vertex, hanging still from two corners: its springs alone would stretch by a
/// third.
scene::Scene heavy(scene::Method method, std::optional<double> limit) {
  scene::Scene scene = test::sheet(25, 25);
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{24, 0}, {}}};
  scene.cloths[0].springs().strain_limit = limit;
  scene.solver.method = method;
  scene.solver.iterations = 1;
  // Explicit Euler is stable only below damping / stiffness, 1e-4 s; implicit Euler at any step.
  scene.solver.dt = method == scene::Method::explicit_euler ? 5e-5 : 1e-3;
  if (method == scene::Method::implicit_euler) scene.solver.dt = 5e-3;
  return scene;
}

}  // namespace

TEST_CASE(
    "with a strain limit no spring of a heavy hanging cloth is longer than that after a step of any method") {
  const auto context = test::context();
  constexpr double limit = 0.1;
  for (const scene::Method method : test::tried_of(scene::methods)) {
    INFO(scene::name(method));
    const scene::Scene scene = heavy(method, limit);
    const auto simulation = test::simulation(scene);
    const auto steps = static_cast<std::uint32_t>(0.4 / scene.solver.dt);
    for (std::uint32_t look = 0; look < 10; ++look) {
      simulation->step(steps / 10);
      // Roundings of the two ends' coordinates, about 1 m, over the shortest spring.
      CHECK(test::largest_stretch(*simulation) <= limit + 4 * 0x1p-24 / (1.0 / 24));
    }
    CHECK(simulation->strain_limit_work().unconverged == 0);
    CHECK(simulation->strain_limit_work().sweeps > simulation->step_index());  // the limit acted
  }
}

TEST_CASE("without a strain limit the same cloth's springs get longer than that") {
  const auto context = test::context();
  const auto simulation = test::simulation(heavy(scene::Method::symplectic_euler, std::nullopt));
  simulation->step(400);
  CHECK(test::largest_stretch(*simulation) > 0.2);
}

TEST_CASE("the strain limit leaves pins exactly where their motion takes them") {
  const auto context = test::context();
  scene::Scene scene = heavy(scene::Method::symplectic_euler, 0.1);
  const auto free = test::simulation([&] {
    scene::Scene other = scene;
    other.cloths[0].springs().strain_limit.reset();
    return other;
  }());
  const auto limited = test::simulation(scene);
  for (sim::Simulation* simulation : {free.get(), limited.get()}) simulation->step(300);
  const sim::State expected = free->read_state(), found = limited->read_state();
  for (const std::size_t pin : {std::size_t{0}, std::size_t{24}})
    CHECK(found.position[pin] == expected.position[pin]);
}

TEST_CASE("the strain limit keeps the momentum of a free sheet whose springs are all too long") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(9, 7);
  scene.gravity = {0.0, 0.0, 0.0};
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.5};
  // A spin about the cloth's normal so fast that it would tear: v^2 / r = 100 m/s^2 at the edge.
  scene.cloths[0].material = scene::Springs{50.0, 50.0, 0.0, 0.0, 0.02};
  scene.cloths[0].pins = {{scene::AtVertex{31}, scene::Spin{{0.0, 1.0, 0.0}, {0.0, 1.0, 0.5}, 2000.0}},
                          {scene::AtVertex{32}, scene::Spin{{0.0, 1.0, 0.0}, {0.0, 1.0, 0.5}, 2000.0}}};
  const auto simulation = test::simulation(scene);
  simulation->step(300);
  scene.cloths[0].pins.clear();
  REQUIRE(simulation->change(scene));
  const auto momentum = [&] {
    const sim::State state = simulation->read_state();
    glm::dvec3 linear(0.0), angular(0.0);
    double scale = 0.0;
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const glm::dvec3 p = simulation->model().mass[i] * glm::dvec3(state.velocity[i]);
      linear += p;
      angular += glm::cross(glm::dvec3(state.position[i]) - glm::dvec3(0.0, 1.0, 0.5), p);
      scale += glm::length(p);
    }
    return std::tuple{linear, angular, scale};
  };
  const auto [linear_before, angular_before, scale] = momentum();
  const std::uint64_t sweeps_before = simulation->strain_limit_work().sweeps;
  simulation->step(100);
  CHECK(simulation->strain_limit_work().sweeps > sweeps_before + 100);
  const auto [linear, angular, scale_after] = momentum();
  // A correction is a difference of two positions, about 1.2 m from the origin, each rounded, over dt:
  // independent from vertex to vertex and step to step, so four standard deviations of their sum. Arms are
  // below 1 m.
  const double mass = simulation->model().mass[31];
  const double rounding = 0x1p-24 * 1.2 / scene.solver.dt * mass * std::sqrt(63.0 * 100.0);
  CHECK(glm::distance(linear, linear_before) < 4 * rounding);
  CHECK(glm::distance(angular, angular_before) < 4 * rounding);
  CHECK(4 * rounding < 1e-4 * scale);
}

TEST_CASE("a strain limit that nothing reaches changes no bit of the outcome") {
  const auto context = test::context();
  scene::Scene scene = heavy(scene::Method::symplectic_euler, 10.0);
  const auto limited = test::simulation(scene);
  scene.cloths[0].springs().strain_limit.reset();
  const auto free = test::simulation(scene);
  for (sim::Simulation* simulation : {free.get(), limited.get()}) simulation->step(100);
  CHECK(sim::state_hash(limited->read_state()) == sim::state_hash(free->read_state()));
}

namespace {

/// A cloth whose two upper corners swing so fast that no limit of a tenth can be kept.
scene::Scene dragged(scene::Method method, double speed, std::optional<double> limit) {
  constexpr double amplitude = 0.2, pi = 3.14159265358979;
  scene::Scene scene = test::sheet(17, 17);
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.2};
  scene.cloths[0].material = scene::Springs{2000.0, 1000.0, 20.0, 0.1, limit};
  const scene::Oscillate swing{{0.0, 0.0, 1.0}, amplitude, speed / (2.0 * pi * amplitude)};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, swing}, {scene::AtCorner{16, 0}, swing}};
  scene.solver.method = method;
  scene.solver.dt = 0.005;
  scene.solver.iterations = 10;
  return scene;
}

/// The largest kinetic and elastic energy of 60 steps, more than a period of 0.25 s [J].
double liveliest(const scene::Scene& scene) {
  const auto simulation = test::simulation(scene);
  double most = 0.0;
  for (int step = 0; step < 60; ++step) {
    simulation->step(1);
    const sim::Diagnostics now = simulation->diagnose();
    REQUIRE(now.finite);
    most = std::max(most, now.kinetic + now.elastic);
  }
  return most;
}

}  // namespace

TEST_CASE("a strain limit that fast pins forbid gives the cloth no energy") {
  const auto context = test::context();
  for (const scene::Method method :
       {scene::Method::implicit_euler, scene::Method::pbd, scene::Method::xpbd, scene::Method::vbd}) {
    const double limited = liveliest(dragged(method, 5.0, 0.1)),
                 free = liveliest(dragged(method, 5.0, std::nullopt));
    INFO(scene::name(method) << ": " << limited << " J, without a limit " << free);
    // The motions part, and their peaks with them; what a limit gave was 5 to 8 times as much under methods
    // that sweep.
    CHECK(limited < 2.0 * free);
  }
}
