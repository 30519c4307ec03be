// Starts and weights on the GPU: where a cloth begins, the state that reset restores, and the mass that a
// weight adds.
#include <algorithm>

#include "server/scene/method.h"
#include "tests/physics/stage.h"

using namespace clothlab;

namespace {

scene::Scene scattered(scene::Method method) {
  scene::Scene scene = test::sheet(9, 9);
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
  scene.cloths[0].start = scene::Scatter{0.5, 3};
  scene.solver.method = method;
  scene.solver.dt = 1e-4;
  return scene;
}

double farthest(const sim::State& state, const std::vector<glm::dvec3>& expected) {
  double most = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    most = std::max(most, glm::distance(glm::dvec3(state.position[i]), expected[i]));
  return most;
}

}  // namespace

TEST_CASE("a cloth starts at its start positions, and reset and a state gone back to are there again") {
  const auto context = test::context();
  const auto simulation = test::simulation(scattered(scene::Method::symplectic_euler));
  const std::vector<glm::dvec3>& start = simulation->model().start_position;
  const double rounding = 1e-7;  // of places within 2 m, in float32
  CHECK(farthest(simulation->read_state(), start) < rounding);
  simulation->step(50);
  CHECK(farthest(simulation->read_state(), start) > 1e-3);
  simulation->go_back();
  CHECK(farthest(simulation->read_state(), start) < rounding);
  simulation->step(50);
  simulation->reset();
  CHECK(farthest(simulation->read_state(), start) < rounding);
  scene::Scene elsewhere = simulation->scene();
  elsewhere.cloths[0].start = scene::Stretch{{0.0, 0.0, 0.0}};
  REQUIRE(simulation->change(elsewhere));
  CHECK(farthest(simulation->read_state(), simulation->model().start_position) < rounding);
  CHECK(simulation->model().start_position[40] == simulation->model().start_position[41]);
}

TEST_CASE("from a random start every method does on the GPU what it does in the reference") {
  const auto context = test::context();
  for (const scene::Method method : scene::methods) {
    const scene::Scene scene = scattered(method);
    const auto simulation = test::simulation(scene);
    const reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    double moved = 0.0;
    for (int n = 0; n < 20; ++n) reference::step(world, state);
    simulation->step(20);
    for (std::size_t i = 0; i < state.position.size(); ++i)
      moved = std::max(moved, glm::distance(state.position[i], world.model.start_position[i]));
    const double error = farthest(simulation->read_state(), state.position);
    INFO(scene::name(method) << ": moved " << moved << " m, off by " << error << " m");
    CHECK(moved > 0.01);
    CHECK(error < 1e-3 * moved);
  }
}

TEST_CASE("a weight weighs on the GPU, from the start and when it is put on a running cloth") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(9, 9);
  const auto simulation = test::simulation(scene);
  const double before = simulation->diagnose().gravitational;
  simulation->step(10);
  scene.cloths[0].weights = {{scene::AtVertex{40}, 1000.0}};
  REQUIRE(sim::change_depth(simulation->scene(), scene) == sim::ChangeDepth::uniform);
  REQUIRE(simulation->change(scene));
  CHECK(simulation->step_index() == 10);
  const glm::vec3 place = simulation->read_state().position[40];
  simulation->reset();
  CHECK(place.y < 1.0f);
  CHECK(simulation->diagnose().gravitational - before == Approx(1000.0 * 9.8 * 1.0).epsilon(1e-5));
  CHECK(test::simulation(scene)->diagnose().gravitational ==
        Approx(simulation->diagnose().gravitational).epsilon(1e-6));
}
