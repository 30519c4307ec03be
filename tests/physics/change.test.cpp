// Live changes of the scene: how much each rebuilds, and that only a new cloth resets time.
#include "server/scene/method.h"
#include "tests/scenes.h"

using namespace clothlab;
using sim::ChangeDepth;

namespace {

template <class Edit>
scene::Scene edited(Edit edit) {
  scene::Scene scene = test::seed();
  edit(scene);
  return scene;
}

}  // namespace

TEST_CASE("a change says how deep it cuts") {
  const auto depth = [](auto edit) { return sim::change_depth(test::seed(), edited(edit)); };
  CHECK(depth([](scene::Scene&) {}) == ChangeDepth::none);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].color = "#000000"; }) == ChangeDepth::none);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].springs().structural = 100.0; }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].mass.value = 0.2; }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.solver.dt = 0.0005; }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.gravity = glm::dvec3(0.0); }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.colliders[0].friction = 0.9; }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.self_collision->thickness = 0.02; }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) {
          std::get<scene::Oscillate>(s.cloths[0].pins[0].motion).amplitude = 0.1;
        }) == ChangeDepth::kernel);  // now the two pins move differently
  CHECK(depth([](scene::Scene& s) { s.cloths[0].springs().bend = 0.0; }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].pins.pop_back(); }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) { s.colliders.clear(); }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) { s.self_collision.reset(); }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) { s.solver.method = scene::Method::rk4; }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].springs().strain_limit = 0.1; }) == ChangeDepth::kernel);
  CHECK(depth([](scene::Scene& s) {
          s.cloths[0].mesh = scene::Grid{10, 10, 1.0, 1.0};
        }) == ChangeDepth::cloth);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].transform.translate.y = 2.0; }) == ChangeDepth::cloth);
  CHECK(depth([](scene::Scene& s) { s.cloths[0].start = scene::Scatter{}; }) == ChangeDepth::cloth);
  CHECK(depth([](scene::Scene& s) {
          s.cloths[0].weights = {{scene::AtVertex{300}, 1.0}};
        }) == ChangeDepth::uniform);
  CHECK(depth([](scene::Scene& s) { s.cloths.push_back(s.cloths[0]); }) == ChangeDepth::cloth);
  CHECK(depth([](scene::Scene& s) {
          s.cloths[0].pins.push_back({scene::AtVertex{300}, {}});
        }) == ChangeDepth::cloth);
}

TEST_CASE("a strain limit that is there is changed as a number, one that comes or goes is another kernel") {
  const scene::Scene limited = edited([](scene::Scene& s) { s.cloths[0].springs().strain_limit = 0.1; });
  const scene::Scene tighter = edited([](scene::Scene& s) { s.cloths[0].springs().strain_limit = 0.05; });
  CHECK(sim::change_depth(limited, tighter) == ChangeDepth::uniform);
  CHECK(sim::change_depth(limited, test::seed()) == ChangeDepth::kernel);
}

TEST_CASE("another method takes the cloth over where it is") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  for (const scene::Method method : scene::methods) {
    INFO(scene::name(method));
    simulation->step(20);
    const sim::State before = simulation->read_state();
    scene::Scene next = simulation->scene();
    next.solver.method = method;
    next.solver.dt = 0.0002;  // explicit Euler stands 4 ms of these
    REQUIRE(simulation->change(next));
    CHECK(sim::state_hash(simulation->read_state()) == sim::state_hash(before));
    simulation->step(20);
    const sim::State after = simulation->read_state();
    // In 20 steps no vertex moves farther than its speed, gravity and the springs allow.
    for (std::size_t i = 0; i < after.position.size(); ++i) {
      const float way = glm::distance(after.position[i], before.position[i]);
      CHECK(way <= 20 * 0.0002f * (2.0f * glm::length(before.velocity[i]) + 1.0f));
    }
  }
}

TEST_CASE("uniforms and kernels change under a running cloth, only a new cloth starts at time 0") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(100);
  const sim::State before = simulation->read_state();

  const scene::Scene stiffer = edited([](scene::Scene& s) { s.cloths[0].springs().structural = 10000.0; });
  REQUIRE(*simulation->change(stiffer) == ChangeDepth::uniform);
  const scene::Scene bare = edited([](scene::Scene& s) { s.self_collision.reset(); });
  REQUIRE(*simulation->change(bare) == ChangeDepth::kernel);
  REQUIRE(simulation->step_index() == 100);
  REQUIRE(sim::state_hash(simulation->read_state()) == sim::state_hash(before));
  const std::uint32_t topology = simulation->topology_revision();

  const scene::Scene smaller = edited([](scene::Scene& s) {
    s.cloths[0].mesh = scene::Grid{9, 9, 1.0, 1.0};
    s.cloths[0].pins.clear();
  });
  REQUIRE(*simulation->change(smaller) == ChangeDepth::cloth);
  REQUIRE(simulation->step_index() == 0);
  REQUIRE(simulation->model().vertex_count() == 81);
  REQUIRE(simulation->topology_revision() > topology);
}

TEST_CASE("a live change of every parameter does what starting with it does") {
  const auto context = test::context();
  const scene::Scene target = edited([](scene::Scene& s) {
    s.cloths[0].material = scene::Springs{15000.0, 8000.0, 0.0, 1.0};
    s.cloths[0].mass.value = 0.15;
    s.gravity = {0.5, -5.0, 0.0};
    s.air_drag = 0.3;
    s.colliders[0].shape = scene::Sphere{{0.0, 0.7, 0.3}, 0.2};
    s.self_collision->thickness = 0.008;
    s.solver.dt = 0.0008;
    std::get<scene::Oscillate>(s.cloths[0].pins[0].motion).frequency = 1.0;
  });
  const auto fresh = test::simulation(target);
  const auto changed = test::simulation(test::seed());
  REQUIRE(changed->change(target));
  fresh->step(300);
  changed->step(300);
  REQUIRE(sim::state_hash(changed->read_state()) == sim::state_hash(fresh->read_state()));
}

TEST_CASE("a pin taken away lets its vertex fall from where it is") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(2, 2);
  scene.cloths[0].material = scene::Springs{0.0, 0.0, 0.0, 0.0};  // no springs: each vertex moves on its own
  scene.cloths[0].pins = {{scene::AtVertex{0}, {}}};
  const auto simulation = test::simulation(scene);
  simulation->step(10);
  REQUIRE(simulation->read_state().position[0].y == 1.0f);
  scene.cloths[0].pins.clear();
  REQUIRE(simulation->change(scene));
  simulation->step(10);
  REQUIRE(simulation->step_index() == 20);
  REQUIRE(simulation->read_state().position[0].y < 1.0f);
}

TEST_CASE("a change that cannot be made leaves the running scene as it was") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(50);
  const std::uint64_t before = sim::state_hash(simulation->read_state());
  const auto change = simulation->change(edited([](scene::Scene& s) {
    s.cloths[0].pins[0].at = scene::AtCorner{99, 0};
  }));
  REQUIRE_FALSE(change);
  REQUIRE(change.error().where == "/cloths/0/pins/0/at");
  REQUIRE(sim::state_hash(simulation->read_state()) == before);
  simulation->step(1);
  REQUIRE(simulation->step_index() == 51);
}
