// Steps that are queued in pieces end in the same bits as whole ones.
#include "server/model/crowding.h"
#include "server/scene/method.h"
#include "server/stream/packer.h"
#include "tests/methods.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

/// A cloth larger than one work group sweeps, with everything that may stop within a step: contacts, a moving
/// pin, a limit on strain.
scene::Scene busy(scene::Method method, int side) {
  scene::Scene scene = test::seed();
  scene.cloths[0].mesh = scene::Grid{side, side, 1.0, 1.0};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, scene::Oscillate{{0, 0, 1}, 0.2, 5.0}}};
  scene.cloths[0].springs().strain_limit = 0.05;
  scene.colliders[0].shape = scene::Sphere{{0.0, 0.99, 0.5}, 0.25};
  scene.self_collision->thickness = 1.2 / side;
  scene.solver.method = method;
  scene.solver.iterations = 3;
  scene.solver.dt = 0.0005;
  return scene;
}

scene::Scene busy_without_limit(scene::Method method) {
  scene::Scene scene = busy(method, 33);
  scene.cloths[0].springs().strain_limit = std::nullopt;
  return scene;
}

constexpr scene::Method every_method[] = {scene::Method::explicit_euler, scene::Method::symplectic_euler,
                                          scene::Method::verlet,         scene::Method::rk4,
                                          scene::Method::implicit_euler, scene::Method::pbd,
                                          scene::Method::xpbd,           scene::Method::vbd};

}  // namespace

TEST_CASE("a step that stops wherever it may, while frames and diagnostics are made, ends in the same bits") {
  const auto context = test::context();
  const auto [method, side] = GENERATE(table<scene::Method, int>({{scene::Method::explicit_euler, 20},
                                                                  {scene::Method::symplectic_euler, 20},
                                                                  {scene::Method::verlet, 20},
                                                                  {scene::Method::rk4, 20},
                                                                  {scene::Method::implicit_euler, 20},
                                                                  {scene::Method::pbd, 33},
                                                                  {scene::Method::xpbd, 33},
                                                                  {scene::Method::vbd, 33}}));
  if (!test::tried(method)) return;
  INFO(scene::name(method));
  constexpr std::uint32_t steps = 4;
  const auto whole = test::simulation(busy(method, side));
  whole->step(steps);

  const auto pieces = test::simulation(busy(method, side));
  auto packer = stream::Packer::create();
  REQUIRE(packer);
  pieces->set_steps_to_do(steps);
  std::uint64_t stops = 0, last_step = 0;
  while (pieces->steps_to_do() > 0) {
    sim::Pace one;
    one.most_places = 1;
    pieces->resume(one);
    REQUIRE(pieces->step_index() >= last_step);
    last_step = pieces->step_index();
    REQUIRE(pieces->step_index() + pieces->steps_to_do() == steps);
    if (++stops % 29 != 0) continue;
    (*packer)->request(*pieces, stream::Encoding::q16, 0);
    const stream::SharedMessage frame = (*packer)->wait();
    REQUIRE(frame->header.step == last_step);
    REQUIRE(pieces->diagnose().step == last_step);
  }
  CHECK(stops > 2 * steps);
  CHECK(pieces->step_index() == steps);
  CHECK(sim::state_hash(pieces->read_state()) == sim::state_hash(whole->read_state()));
}

TEST_CASE("between two pieces the state shown is that of the last whole step, under every method") {
  const auto context = test::context();
  for (const scene::Method method : test::tried_of(every_method)) {
    INFO(scene::name(method));
    const auto simulation = test::simulation(busy(method, 33));
    simulation->step(3);
    const std::uint64_t before = sim::state_hash(simulation->read_state());
    simulation->set_steps_to_do(1);
    for (int stops = 0; simulation->step_index() == 3; ++stops) {
      if (stops % 29 < 2) REQUIRE(sim::state_hash(simulation->read_state()) == before);
      sim::Pace one;
      one.most_places = 1;
      simulation->resume(one);
    }
    CHECK(sim::state_hash(simulation->read_state()) != before);
  }
}

TEST_CASE("a step given up half-way for a change leaves the state where it was, and the run goes on") {
  const auto context = test::context();
  for (const scene::Method method : test::tried_of(every_method)) {
    INFO(scene::name(method));
    scene::Scene scene = busy_without_limit(method);
    const auto simulation = test::simulation(scene);
    simulation->step(3);
    const std::uint64_t before = sim::state_hash(simulation->read_state());
    simulation->set_steps_to_do(5);
    sim::Pace three;
    three.most_places = 3;
    simulation->resume(three);
    if (simulation->step_index() > 3) continue;  // it cannot stop within a step
    scene.gravity.y = -5.0;
    REQUIRE(simulation->change(scene));
    CHECK(simulation->steps_to_do() == 0);
    CHECK(simulation->step_index() == 3);
    CHECK(sim::state_hash(simulation->read_state()) == before);
    simulation->step(5);
    // Like a step that never began, except that the method and the limits remember earlier steps.
    const auto whole = test::simulation(busy_without_limit(method));
    whole->step(3);
    REQUIRE(whole->change(scene));
    whole->step(5);
    const sim::Diagnostics found = simulation->diagnose(), expected = whole->diagnose();
    CHECK(found.finite);
    CHECK(found.max_strain == Approx(expected.max_strain).epsilon(0.2));
    CHECK(found.contacts == Approx(expected.contacts).epsilon(0.2));
  }
}

TEST_CASE("steps that are not wanted any more are not made, and the one under way waits") {
  const auto context = test::context();
  const auto simulation = test::simulation(busy(scene::Method::xpbd, 33));
  sim::Pace few;
  few.most_places = 3;
  simulation->set_steps_to_do(5);
  simulation->resume(few);
  simulation->set_steps_to_do(0);
  sim::Pace unlimited;
  simulation->resume(unlimited);
  CHECK(simulation->step_index() == 0);
  simulation->set_steps_to_do(1);
  simulation->resume(unlimited);
  CHECK(simulation->step_index() == 1);
  simulation->step(2);
  const auto whole = test::simulation(busy(scene::Method::xpbd, 33));
  whole->step(3);
  CHECK(sim::state_hash(simulation->read_state()) == sim::state_hash(whole->read_state()));
}

TEST_CASE("the crowding of a sheet is what its cells hold, and of vertices in one place all of them") {
  std::vector<glm::dvec3> sheet, heap(500, glm::dvec3(0.3));
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) sheet.emplace_back(0.01 * i, 0.2, 0.01 * j);
  // Four of the eight cells lie in its plane, each of 10 x 10 vertices; two in the outermost half of a cell,
  // a fortieth of the sheet at each of its four edges. The sample of 1000 is good for 1 %.
  CHECK(model::crowding(sheet, 0.1) == Approx(400.0 * 0.975 * 0.975 - 1.0).epsilon(0.01));
  CHECK(model::crowding(heap, 0.1) == Approx(499.0));
  CHECK(model::crowding({}, 0.1) == 0.0);
}

TEST_CASE("a search that would hold too many vertices against each other is refused before it is made") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(400, 400);
  scene.self_collision = scene::SelfCollision{10.0, 0.2};  // every vertex against every other: 2.6e10 pairs
  const Result<std::unique_ptr<sim::Simulation>> refused = sim::Simulation::create(scene);
  REQUIRE(!refused);
  CHECK(refused.error().where == "/self_collision/thickness");
  scene.self_collision->thickness = 0.0025;
  const auto simulation = test::simulation(scene);
  const std::uint64_t before = sim::state_hash(simulation->read_state());
  scene.self_collision->thickness = 10.0;
  CHECK(!simulation->change(scene));
  CHECK(simulation->scene().self_collision->thickness == 0.0025);
  CHECK(sim::state_hash(simulation->read_state()) == before);
}
