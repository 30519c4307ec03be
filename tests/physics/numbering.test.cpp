// Vertices that lie in memory in another order than in the scene.
#include "server/model/numbering.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>
#include <string>

#include "server/scene/method.h"
#include "server/stream/packer.h"
#include "tests/checked_context.h"
#include "tests/physics/stage.h"
#include "tests/sheets.h"

using namespace clothlab;

namespace {

constexpr int fewest_cells = 70;  // 5041 vertices: hardly more than the fewest that are numbered anew

struct Pair {
  scene::Scene ordered, shuffled;
  std::vector<std::uint32_t> to;  ///< where a vertex of the first is in the second
};

/// The same sheet twice, held at three of its vertices and weighted at a fourth, once with its vertices and
/// triangles in any order. It starts stretched, so that masses matter, and in wind, so that triangles do.
Pair sheets(scene::Method method, int cells = fewest_cells) {
  Pair pair;
  pair.ordered = test::sheet_of(test::Cut::one_diagonal, cells, {200.0, 100.0, 20.0, 0.01});
  pair.ordered.cloths[0].start = scene::Stretch{{1.01, 1.0, 1.01}};
  pair.ordered.wind = scene::Wind{};
  pair.ordered.wind->velocity = {2.0, 1.0, 0.0};
  pair.ordered.gravity = {0, -9.8, 0};
  // What a solve with a larger tolerance leaves would be more than rounding; so would what a second Newton
  // step leaves, which ends where rounding in the forces begins.
  pair.ordered.solver = {
      .method = method, .dt = scene::solves(method) ? 5e-4 : 1e-4, .iterations = 1, .tolerance = 1e-7};
  pair.shuffled = pair.ordered;
  auto& from = std::get<scene::TriangleMesh>(pair.ordered.cloths[0].mesh);
  auto& to = std::get<scene::TriangleMesh>(pair.shuffled.cloths[0].mesh);
  pair.to.resize(from.vertices.size());
  std::iota(pair.to.begin(), pair.to.end(), 0u);
  std::mt19937 random(3);
  for (std::size_t i = pair.to.size() - 1; i > 0; --i) std::swap(pair.to[i], pair.to[random() % (i + 1)]);
  for (std::size_t i = 0; i < pair.to.size(); ++i) to.vertices[pair.to[i]] = from.vertices[i];
  for (auto& corners : to.triangles)
    for (std::uint32_t& corner : corners) corner = pair.to[corner];
  for (std::size_t i = to.triangles.size() - 1; i > 0; --i)
    std::swap(to.triangles[i], to.triangles[random() % (i + 1)]);
  for (const std::uint32_t held : {0u, 35u, 70u}) {
    pair.ordered.cloths[0].pins.push_back({scene::AtVertex{held}, {}});
    pair.shuffled.cloths[0].pins.push_back({scene::AtVertex{pair.to[held]}, {}});
  }
  pair.ordered.cloths[0].weights.push_back({scene::AtVertex{2500}, 0.01});
  pair.shuffled.cloths[0].weights.push_back({scene::AtVertex{pair.to[2500]}, 0.01});
  return pair;
}

double farthest(const std::vector<glm::vec3>& ordered, const std::vector<glm::vec3>& shuffled,
                const std::vector<std::uint32_t>& to) {
  double most = 0.0;
  for (std::size_t i = 0; i < to.size(); ++i)
    most = std::max(most, static_cast<double>(glm::distance(ordered[i], shuffled[to[i]])));
  return most;
}

}  // namespace

TEST_CASE("a shuffled mesh moves as the ordered one does, at the scene's indices") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::implicit_euler}) {
    const Pair pair = sheets(method);
    REQUIRE(model::near_places(*model::build(pair.ordered), pair.ordered).empty());
    REQUIRE_FALSE(model::near_places(*model::build(pair.shuffled), pair.shuffled).empty());
    const auto ordered = test::simulation(pair.ordered), shuffled = test::simulation(pair.shuffled);
    const std::uint32_t steps = scene::solves(method) ? 20 : 100;  // 0.01 s
    for (const auto* each : {&ordered, &shuffled}) (*each)->step(steps);
    const sim::State a = ordered->read_state(), b = shuffled->read_state();
    // Sums in another order: up to 100 steps of a rounding of 1e-7 of a metre or so. The cloth has fallen by
    // 0.5 mm, less what the wind holds up.
    CHECK(farthest(a.position, b.position, pair.to) < 2e-6);
    CHECK(a.position[2485].y < -2e-4f);
    CHECK(a.position[35].y == 0.0f);
  }
}

TEST_CASE("what a renumbered simulation hands out and takes back is in the scene's order") {
  const auto context = test::context();
  Pair pair = sheets(scene::Method::symplectic_euler);
  const auto shuffled = test::simulation(pair.shuffled);
  const auto& mesh = std::get<scene::TriangleMesh>(pair.shuffled.cloths[0].mesh);
  CHECK(shuffled->model().triangles == mesh.triangles);
  CHECK(shuffled->model().rest_position == mesh.vertices);
  shuffled->step(50);
  const sim::State state = shuffled->read_state();

  auto packer = stream::Packer::create();
  REQUIRE(packer);
  REQUIRE((*packer)->request(*shuffled, stream::Encoding::f32, 0));
  const stream::SharedMessage frame = (*packer)->wait();
  REQUIRE(frame);
  std::size_t different = 0;
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    glm::vec3 shown;
    std::memcpy(&shown, frame->data() + stream::header_bytes + 24 * i, sizeof(shown));
    different += shown != state.position[i];
  }
  CHECK(different == 0);

  REQUIRE((*packer)->request(*shuffled, {stream::Encoding::f32, stream::Field::speed}, 0));
  const stream::SharedMessage speeds = (*packer)->wait();
  REQUIRE(speeds);
  const std::uint8_t* bytes = speeds->data() + speeds->size() - state.position.size();
  for (std::size_t i = 0; i < state.position.size(); ++i)
    // The byte next to it, where rounding of the quotient decides.
    different += std::abs(255.0f * glm::length(state.velocity[i]) / speeds->header.range - bytes[i]) > 0.501f;
  CHECK(different == 0);

  shuffled->restore(state, 0.1, 1000);
  CHECK(sim::state_hash(shuffled->read_state()) == sim::state_hash(state));

  // Another mass, another pin: numbers that a running simulation takes over.
  pair.shuffled.cloths[0].pins.push_back({scene::AtVertex{pair.to[2485]}, {}});
  REQUIRE(shuffled->change(pair.shuffled));
  shuffled->step(20);
  CHECK(state.position[pair.to[2485]].y < 0.0f);
  CHECK(shuffled->read_state().position[pair.to[2485]] == glm::vec3(mesh.vertices[pair.to[2485]]));
  shuffled->reset();
  CHECK(shuffled->read_state().position[pair.to[35]] == glm::vec3(mesh.vertices[pair.to[35]]));
}

TEST_CASE("every vertex gets one place in its cloth's part, and grids and small meshes keep theirs") {
  Pair pair = sheets(scene::Method::symplectic_euler);
  pair.shuffled.cloths.push_back(pair.shuffled.cloths[0]);
  const model::Model model = *model::build(pair.shuffled);
  std::vector<std::uint32_t> places = model::near_places(model, pair.shuffled);
  const std::size_t half = pair.to.size();
  REQUIRE(places.size() == 2 * half);
  for (std::size_t i = 0; i < places.size(); ++i) REQUIRE((places[i] < half) == (i < half));
  std::sort(places.begin(), places.end());
  for (std::uint32_t i = 0; i < places.size(); ++i) REQUIRE(places[i] == i);
  scene::Scene grid = test::sheet_of(test::Cut::grid, 3, {});
  grid.cloths[0].mesh = scene::Grid{1000, 5, 1.0, 1.0};
  CHECK(model::near_places(*model::build(grid), grid).empty());
  const scene::Scene small = sheets(scene::Method::symplectic_euler, 60).shuffled;
  CHECK(model::near_places(*model::build(small), small).empty());
}

TEST_CASE("a renumbered model has all that belongs to a vertex at its new place, and pairs in rising order") {
  scene::Scene scene = sheets(scene::Method::symplectic_euler).shuffled;
  scene.self_collision = scene::SelfCollision{0.005, 0.2};
  const model::Model before = *model::build(scene);
  const std::vector<std::uint32_t> places = model::near_places(before, scene);
  model::Model after = model::renumbered(before, places);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t place = places[i];
    wrong += after.rest_position[place] != before.rest_position[i] ||
             after.start_position[place] != before.start_position[i] || after.mass[place] != before.mass[i] ||
             after.pin_motion[place] != before.pin_motion[i] ||
             after.vertex_cloth[place] != before.vertex_cloth[i] ||
             after.texture_coordinates[place] != before.texture_coordinates[i];
    // The vertices that contact leaves out are the same, at their places.
    std::vector<std::uint32_t> left_out, expected;
    for (auto at = before.contact_exclusions.offsets[i]; at < before.contact_exclusions.offsets[i + 1]; ++at)
      expected.push_back(places[before.contact_exclusions.items[at]]);
    for (auto at = after.contact_exclusions.offsets[place]; at < after.contact_exclusions.offsets[place + 1];
         ++at)
      left_out.push_back(after.contact_exclusions.items[at]);
    std::sort(expected.begin(), expected.end());
    std::sort(left_out.begin(), left_out.end());
    wrong += left_out != expected || left_out.empty();
  }
  CHECK(wrong == 0);
  for (std::size_t t = 0; t < before.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) wrong += after.triangles[t][k] != places[before.triangles[t][k]];
  CHECK(wrong == 0);
  after.elements.each_of_all([&](const auto& batch) {
    for (const auto& element : batch)
      if constexpr (std::tuple_size_v<std::decay_t<decltype(element.vertices)>> == 2)
        wrong += element.vertices[0] >= element.vertices[1];
  });
  CHECK(wrong == 0);
}

TEST_CASE("no barrier is missing where vertices lie in memory in another order") {
  const test::BarrierContext context;
  const auto simulation = test::simulation(sheets(scene::Method::symplectic_euler).shuffled);
  const auto packer = stream::Packer::create();
  REQUIRE(packer);
  simulation->step(2);
  (*packer)->request(*simulation, {stream::Encoding::q16, stream::Field::strain}, 0);
  REQUIRE((*packer)->wait());
  for (const std::string& fault : context.faults()) UNSCOPED_INFO(fault);
  CHECK(context.faults().empty());
}
