// The same scene, device and build give the same bits.
#include "server/stream/packer.h"
#include "tests/methods.h"
#include "tests/scenes.h"
#include "tests/small_scenes.h"

using namespace clothlab;

namespace {

std::uint64_t hash_after(const scene::Scene& scene, const std::vector<std::uint32_t>& batches) {
  const auto simulation = test::simulation(scene);
  for (const std::uint32_t batch : batches) simulation->step(batch);
  return sim::state_hash(simulation->read_state());
}

}  // namespace

TEST_CASE("two runs of the seed scene in one process end in the same bits, however the steps are grouped") {
  const auto context = test::threaded_context();
  const std::uint64_t expected = hash_after(test::seed(), {1500});
  REQUIRE(hash_after(test::seed(), {1500}) == expected);
  REQUIRE(hash_after(test::seed(), {1, 499, 33, 967}) == expected);
  scene::Scene heavier = test::seed();
  heavier.cloths[0].mass.value *= 1.0001;
  REQUIRE(hash_after(heavier, {1500}) != expected);  // the hash differs for another scene
}

TEST_CASE("two runs of a sheet of finite elements end in the same bits, under every method") {
  const auto context = test::threaded_context();
  for (const scene::Method method : test::tried_of(test::sheet_methods())) {
    scene::Scene scene = test::sheet_of_elements(method, scene::iterates(method) ? 2e-3 : 5e-5, 25, 2e-4);
    scene.gravity = {0.0, -9.81, 0.0};
    scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{24, 0}, {}}};
    scene.colliders = {{"ball", scene::Sphere{{0.0, -0.1, 0.15}, 0.05}, 0.3, 0.0, {}}};
    scene.self_collision = scene::SelfCollision{0.003, 0.2};
    const std::uint32_t steps = scene::iterates(method) ? 16 : 200;
    INFO(scene::name(method));
    const std::uint64_t expected = hash_after(scene, {steps});
    CHECK(hash_after(scene, {steps}) == expected);
    CHECK(hash_after(scene, {1, steps / 4, steps - 1 - steps / 4}) == expected);
    std::get<scene::Fem>(scene.cloths[0].material).grain += 1.0;
    CHECK(hash_after(scene, {steps}) != expected);
  }
}

TEST_CASE("watching does not change what is watched: frames and diagnostics leave the state's bits alone") {
  const auto context = test::threaded_context();
  const std::uint64_t expected = hash_after(test::seed(), {400});
  const auto simulation = test::simulation(test::seed());
  auto packer = stream::Packer::create();
  REQUIRE(packer);
  for (int frame = 0; frame < 25; ++frame) {
    simulation->step(16);
    (*packer)->request(*simulation, frame % 2 ? stream::Encoding::q16 : stream::Encoding::f32, 0);
    REQUIRE((*packer)->wait());
    simulation->diagnose();
  }
  REQUIRE(sim::state_hash(simulation->read_state()) == expected);
}

TEST_CASE("reset brings back the start: the same steps after it end in the same bits") {
  const auto context = test::threaded_context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(700);
  const std::uint64_t first = sim::state_hash(simulation->read_state());
  simulation->reset();
  REQUIRE(simulation->time() == 0.0);
  simulation->step(700);
  REQUIRE(sim::state_hash(simulation->read_state()) == first);
}
