// The same scene, device and build give the same bits.
#include "server/stream/packer.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

std::uint64_t hash_after(const scene::Scene& scene, const std::vector<std::uint32_t>& batches) {
  const auto simulation = test::simulation(scene);
  for (const std::uint32_t batch : batches) simulation->step(batch);
  return sim::state_hash(simulation->read_state());
}

}  // namespace

TEST_CASE("two runs of the seed scene in one process end in the same bits, however the steps are grouped") {
  const auto context = test::context();
  const std::uint64_t expected = hash_after(test::seed(), {1500});
  REQUIRE(hash_after(test::seed(), {1500}) == expected);
  REQUIRE(hash_after(test::seed(), {1, 499, 33, 967}) == expected);
  scene::Scene heavier = test::seed();
  heavier.cloths[0].mass.value *= 1.0001;
  REQUIRE(hash_after(heavier, {1500}) != expected);  // the hash differs for another scene
}

TEST_CASE("watching does not change what is watched: frames and diagnostics leave the state's bits alone") {
  const auto context = test::context();
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
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  simulation->step(700);
  const std::uint64_t first = sim::state_hash(simulation->read_state());
  simulation->reset();
  REQUIRE(simulation->time() == 0.0);
  simulation->step(700);
  REQUIRE(sim::state_hash(simulation->read_state()) == first);
}
