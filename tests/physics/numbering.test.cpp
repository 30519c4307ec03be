// Vertices that lie in memory in another order than in the scene.
#include "server/model/numbering.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include "server/stream/packer.h"
#include "tests/physics/stage.h"
#include "tests/sheets.h"

using namespace clothlab;

namespace {

constexpr int cells = 70;  // 5041 vertices: as few as are numbered anew

struct Pair {
  scene::Scene ordered, shuffled;
  std::vector<std::uint32_t> to;  ///< where a vertex of the first is in the second
};

/// The same sheet twice, held at three of its vertices and weighted at a fourth, once with its vertices and
/// triangles in any order.
Pair sheets(scene::Method method) {
  Pair pair;
  pair.ordered = test::sheet_of(test::Cut::one_diagonal, cells, {200.0, 100.0, 20.0, 0.01});
  pair.ordered.gravity = {0, -9.8, 0};
  pair.ordered.solver = {.method = method, .dt = 1e-4};
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
    for (const auto* each : {&ordered, &shuffled}) (*each)->step(100);
    const sim::State a = ordered->read_state(), b = shuffled->read_state();
    // Sums in another order: 100 steps of a rounding of 1e-7 of a metre or so. The cloth has fallen by 0.5
    // mm.
    CHECK(farthest(a.position, b.position, pair.to) < 2e-6);
    CHECK(a.position[2485].y < -3e-4f);
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

TEST_CASE("every vertex gets one place, and grids and small meshes keep theirs") {
  const Pair pair = sheets(scene::Method::symplectic_euler);
  std::vector<std::uint32_t> places = model::near_places(*model::build(pair.shuffled), pair.shuffled);
  std::sort(places.begin(), places.end());
  for (std::uint32_t i = 0; i < places.size(); ++i) REQUIRE(places[i] == i);
  scene::Scene grid = test::sheet_of(test::Cut::grid, 3, {});
  grid.cloths[0].mesh = scene::Grid{1000, 5, 1.0, 1.0};
  CHECK(model::near_places(*model::build(grid), grid).empty());
  const scene::Scene small = test::sheet_of(test::Cut::irregular, 20, {});
  CHECK(model::near_places(*model::build(small), small).empty());
}
