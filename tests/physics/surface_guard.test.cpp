// Contact between surfaces lets nothing through, whatever is thrown at what, and a step whose pairs are not
// known is not taken.
//
// CLOTHLAB_THROW_SEEDS=FROM-TO tries other seeds than the few of every run, CLOTHLAB_THROW_HEAVY=1 with
// bodies of up to 50,000 triangles.
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <tuple>

#include "server/sim/list_memory.h"
#include "tests/body_meshes.h"
#include "tests/crossings.h"
#include "tests/physics/thrown_cloth.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

/// A sheet that falls flat on an open plate of 800 triangles, `speed` [m/s] at the start.
test::ThrownCloth fast_on_plate(scene::Method method, double dt, double speed) {
  test::ThrownCloth made;
  made.plate = true;
  made.words = scene::name(method);
  scene::Cloth& cloth = made.scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{25, 25, 0.55, 0.55};
  cloth.transform.translate = {0.0, 0.1, -0.275};
  cloth.mass = {scene::Mass::Kind::area_density, 0.2};
  cloth.material = scene::Springs{1000.0, 500.0, 5.0, 0.05};
  scene::Transform place;
  place.scale = 0.6;
  made.scene.colliders = {test::body_of(test::plate_mesh(20), place)};
  made.scene.self_collision = scene::SelfCollision{0.008, 0.3, scene::ContactKind::surface};
  made.scene.solver = {method, dt, 10, 1e-4};
  made.velocity = {0.0f, -static_cast<float>(speed), 0.0f};
  return made;
}

}  // namespace

TEST_CASE(
    "cloth that falls at 8 m/s on an open plate goes through nothing, under every method of long steps") {
  const auto context = test::context();
  using scene::Method;
  test::Part part(3);
  for (const Method method : {Method::implicit_euler, Method::pbd, Method::xpbd, Method::vbd}) {
    if (part.leaves_out()) continue;
    const test::ThrownCloth thrown = fast_on_plate(method, 0.01, 8.2);
    const auto simulation = test::simulation(thrown.scene);
    test::Watched watched(thrown, *simulation);
    std::string wrong;
    double fastest = 0.0;
    for (int step = 0; step < 20 && wrong.empty(); ++step) {
      simulation->step(1);
      wrong = watched.wrong();
      if (step > 1) fastest = std::max(fastest, simulation->diagnose().max_speed);
    }
    INFO(thrown.words);
    CHECK(wrong == "");
    // The second step meets the plate: the way that is left to it, over dt, is still the speed that implicit
    // Euler ends it with. There is no restitution, and the whole sheet arrives at once: it stops, but for
    // what the solve's tolerance and slanting pairs at its rim leave. Sums of pushes that overflowed left one
    // vertex 8 m/s.
    CHECK(fastest < 0.5);
    CHECK(simulation->diagnose().surface_not_taken == 0);
  }
}

TEST_CASE("cloth that is thrown at bodies of triangles goes through nothing, or it is told") {
  const auto context = test::context();
  std::uint64_t from = 1, to = test::thorough() ? 12 : 4;
  if (const char* wanted = std::getenv("CLOTHLAB_THROW_SEEDS")) {
    char* end = nullptr;
    from = to = std::strtoull(wanted, &end, 10);
    if (*end == '-') to = std::strtoull(end + 1, nullptr, 10);
  }
  for (std::uint64_t seed = from; seed <= to; ++seed) {
    const test::ThrownCloth thrown = test::thrown_cloth(seed, std::getenv("CLOTHLAB_THROW_HEAVY") != nullptr);
    const auto simulation = test::simulation(thrown.scene);
    test::Watched watched(thrown, *simulation);
    std::string wrong;
    for (int step = 0; step < thrown.steps && wrong.empty(); ++step) {
      simulation->step(1);
      wrong = watched.wrong();
    }
    CHECK(wrong == "");
    if (!thrown.moves) CHECK(simulation->diagnose().surface_forced == 0);
  }
}

TEST_CASE(
    "a step whose pairs no list has room for is not taken, and is told; then the cloth goes on as it went") {
  const auto context = test::context();
  using scene::Method;
  test::Part part(3);
  // Steps as a whole and in pieces, and with a strain limit, which writes over the step's start.
  for (const auto& [method, dt, limit] : {std::tuple{Method::symplectic_euler, 0.0005, false},
                                          {Method::verlet, 0.0005, true},
                                          {Method::xpbd, 0.01, false},
                                          {Method::implicit_euler, 0.01, true}}) {
    if (part.leaves_out()) continue;
    test::ThrownCloth thrown = fast_on_plate(method, dt, 1.0);
    thrown.scene.cloths[0].transform.translate.y = 0.004;
    if (limit) std::get<scene::Springs>(thrown.scene.cloths[0].material).strain_limit = 0.5;
    const auto simulation = test::simulation(thrown.scene);
    test::Watched watched(thrown, *simulation);
    const sim::State before = simulation->read_state();
    simulation->shorten_contact_lists(4, true);
    simulation->step(3);
    INFO(scene::name(method));
    CHECK(simulation->read_state().position == before.position);
    CHECK(simulation->read_state().velocity == before.velocity);
    CHECK(simulation->diagnose().surface_not_taken == 3);
    CHECK(simulation->diagnose().surface_forced == 3);
    simulation->shorten_contact_lists(64);
    simulation->step(5);
    CHECK(simulation->read_state().position != before.position);
    CHECK(watched.wrong() == "");
    CHECK(simulation->diagnose().surface_not_taken == 3);
  }
}

TEST_CASE(
    "lists that the server has no memory for stay: their steps are not taken, and told, until there is "
    "some") {
  const auto context = test::context();
  const auto budget = MemoryBudget::of(MemoryBudget::least_bytes);
  const auto lists = std::make_shared<sim::ListMemory>(budget);
  sim::ListMemory::of_thread() = lists;
  test::ThrownCloth thrown = fast_on_plate(scene::Method::symplectic_euler, 0.0005, 1.0);
  thrown.scene.cloths[0].transform.translate.y = 0.004;
  const auto simulation = test::simulation(thrown.scene);
  sim::ListMemory::of_thread() = nullptr;
  test::Watched watched(thrown, *simulation);
  auto others = MemoryBudget::reserve(budget, MemoryBudget::Use::simulations,
                                      budget->left(MemoryBudget::Use::simulations) - 100);
  REQUIRE(others);
  const sim::State before = simulation->read_state();
  simulation->shorten_contact_lists(4);
  simulation->step(3);
  CHECK(simulation->read_state().position == before.position);
  CHECK(simulation->diagnose().surface_not_taken == 3);
  CHECK(lists->take_refusal().find("for simulations, where 0 MB are left") != std::string::npos);
  others = MemoryBudget::Reservation();
  // How long the lists need to be is looked at every eight steps.
  simulation->step(12);
  CHECK(simulation->read_state().position != before.position);
  CHECK(watched.wrong() == "");
  CHECK(budget->used(MemoryBudget::Use::simulations) > 0);
  CHECK(lists->take_refusal().empty());
}

TEST_CASE("a step's own list of contact has as much memory as there is: its steps are taken or told") {
  const auto context = test::context();
  std::uint32_t refused = 0;
  // With some of these there is memory for the pairs that may press, and none for those that do.
  for (const std::uint64_t left : {100u, 1000000u, 3000000u, 4000000u, 8000000u, 20000000u}) {
    const auto budget = MemoryBudget::of(MemoryBudget::least_bytes);
    const auto lists = std::make_shared<sim::ListMemory>(budget);
    sim::ListMemory::of_thread() = lists;
    test::ThrownCloth thrown = fast_on_plate(scene::Method::implicit_euler, 0.005, 1.0);
    thrown.scene.cloths[0].transform.translate.y = 0.004;
    const auto simulation = test::simulation(thrown.scene);
    sim::ListMemory::of_thread() = nullptr;
    test::Watched watched(thrown, *simulation);
    auto others = MemoryBudget::reserve(budget, MemoryBudget::Use::simulations,
                                        budget->left(MemoryBudget::Use::simulations) - left);
    REQUIRE(others);
    const sim::State before = simulation->read_state();
    simulation->shorten_contact_lists(4);
    simulation->step(1);
    INFO(left << " bytes left");
    CHECK(watched.wrong() == "");
    const bool stays = simulation->read_state().position == before.position;
    refused += stays ? 1 : 0;
    CHECK(stays == (simulation->diagnose().surface_not_taken == 1));
    CHECK(stays != lists->take_refusal().empty());
    others = MemoryBudget::Reservation();
    simulation->step(12);
    CHECK(simulation->read_state().position != before.position);
    CHECK(watched.wrong() == "");
  }
  CHECK(refused > 0);
  CHECK(refused < 6);
}

TEST_CASE(
    "presets that keep surfaces apart have no crossings when their lists are too short every fifth step") {
  const auto context = test::context();
  for (const std::string& name : scene::preset_names()) {
    const scene::Scene scene = scene::load_preset(name)->scene;
    if (!scene.collides(scene::ContactKind::surface)) continue;
    const auto simulation = test::simulation(scene);
    // Some of the last steps before layers meet (presets.test.cpp) would be as good, but take longer.
    for (int round = 0; round < 5; ++round) {
      simulation->shorten_contact_lists(64);
      simulation->step(5);
    }
    INFO(name);
    CHECK(test::crossings(simulation->model(), simulation->read_state().position).empty());
    CHECK(simulation->diagnose().surface_not_taken == 0);
  }
}

TEST_CASE("a plate that comes up against a sheet takes it along when lists are too short every fifth step") {
  const auto context = test::context();
  using scene::Method;
  for (const Method method : {Method::symplectic_euler, Method::xpbd, Method::implicit_euler}) {
    test::ThrownCloth thrown = fast_on_plate(method, method == Method::symplectic_euler ? 0.0001 : 0.01, 0.0);
    thrown.scene.cloths[0].transform.translate.y = 0.01;
    thrown.scene.colliders[0].motion = scene::Linear{{0.0, 2.0, 0.0}};
    thrown.moves = true;
    const auto simulation = test::simulation(thrown.scene);
    test::Watched watched(thrown, *simulation);
    const std::uint32_t steps = method == Method::symplectic_euler ? 80 : 6;
    for (std::uint32_t step = 0; step < steps; ++step) {
      if (step % 5 == 0) simulation->shorten_contact_lists(64);
      simulation->step(1);
      CHECK(watched.wrong() == "");
    }
    INFO(scene::name(method));
    CHECK(simulation->diagnose().surface_forced == 0);
    for (const glm::vec3& x : simulation->read_state().position) CHECK(x.y > 2.0 * simulation->time());
  }
}
