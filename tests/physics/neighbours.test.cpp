// The neighbour lists of self-collision against brute force over all pairs.
#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <numeric>
#include <random>
#include <set>

#include "server/sim/self_collision.h"
#include "server/sim/state.h"
#include "tests/body_meshes.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

using Lists = std::vector<std::vector<sim::SelfCollision::Neighbour>>;
constexpr double thickness = 0.01;

model::Model sheet_model(int side) {
  scene::Scene scene = test::sheet(side, side);
  scene.self_collision = scene::SelfCollision{thickness, 0.0};
  Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  return std::move(*model);
}

/// The lists that the GPU builds for `model` with its vertices at `position`.
struct Search {
  sim::SelfCollision self_collision;
  gl::TextureBuffer position, rest;

  Search(const model::Model& model, const std::vector<glm::vec4>& at) {
    Result<sim::SelfCollision> made = sim::SelfCollision::create(model);
    INFO((made ? "" : made.error().text()));
    REQUIRE(made);
    self_collision = std::move(*made);
    REQUIRE(self_collision.set_parameters({thickness, 0.0}, model));
    std::vector<glm::vec4> home;
    for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
      home.emplace_back(glm::vec3(model.rest_position[i]), static_cast<float>(model.vertex_cloth[i]));
    position = {gl::Buffer(at), GL_RGBA32F};
    rest = {gl::Buffer(home), GL_RGBA32F};
  }
  Lists run() {
    position.bind(unit_position);
    rest.bind(unit_rest_position);
    sim::Pace unlimited;
    self_collision.update_lists().resume(unlimited);
    return self_collision.read_lists();
  }
};

std::vector<std::set<std::uint32_t>> brute_force(const model::Model& model, const std::vector<glm::vec4>& at,
                                                 float reach) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
  for (const model::Spring& spring : model.springs()) joined.insert({spring.vertices[0], spring.vertices[1]});
  std::vector<std::set<std::uint32_t>> near(at.size());
  for (std::uint32_t i = 0; i < at.size(); ++i)
    for (std::uint32_t j = 0; j < at.size(); ++j)
      if (i != j && glm::distance(glm::vec3(at[i]), glm::vec3(at[j])) < reach &&
          !joined.contains({std::min(i, j), std::max(i, j)}))
        near[i].insert(j);
  return near;
}

void check_against_brute_force(const model::Model& model, const std::vector<glm::vec4>& at) {
  Search search(model, at);
  const Lists lists = search.run();
  const auto expected = brute_force(model, at, search.self_collision.reach());
  std::size_t found = 0;
  for (std::uint32_t i = 0; i < at.size(); ++i) {
    std::set<std::uint32_t> listed;
    for (const auto& neighbour : lists[i]) listed.insert(neighbour.vertex);
    REQUIRE(listed.size() == lists[i].size());  // none twice
    REQUIRE(listed == expected[i]);
    found += listed.size();
  }
  REQUIRE(found > at.size());                                // there are neighbours to find
  for (const auto& list : lists) REQUIRE(list.size() < 64);  // none was cut short
}

std::vector<glm::vec4> random_cloud(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-0.2f, 0.2f);  // also negative cells
  std::vector<glm::vec4> at(count);
  for (glm::vec4& x : at) x = {place(random), place(random), place(random), 1.0f};
  return at;
}

/// Positions of a cloth folded in four layers, 8 mm apart.
std::vector<glm::vec4> folded(const model::Model& model) {
  std::vector<glm::vec4> at;
  for (const glm::dvec3& x : model.rest_position) {
    const double along = x.z * 4.0, layer = std::min(3.0, std::floor(along)), within = along - layer;
    const double z = (static_cast<int>(layer) % 2 == 0 ? within : 1.0 - within) / 4.0;
    at.emplace_back(static_cast<float>(x.x), static_cast<float>(0.008 * layer), static_cast<float>(z), 1.0f);
  }
  return at;
}

}  // namespace

TEST_CASE("neighbour lists hold exactly the pairs that brute force finds in a random cloud") {
  const auto context = test::context();
  const model::Model model = sheet_model(19);  // 361 vertices: not a multiple of the work group
  for (const unsigned seed : {1u, 2u, 3u})
    check_against_brute_force(model, random_cloud(model.vertex_count(), seed));
}

TEST_CASE("no neighbour is listed twice where several cells share a bucket of the hash") {
  const auto context = test::context();
  const model::Model model = sheet_model(3);  // 9 vertices, 32 buckets
  std::mt19937 random(8);
  std::uniform_real_distribution<float> far(-20.0f, 20.0f);
  for (unsigned seed = 0; seed < 30; ++seed) {
    const glm::vec4 offset(far(random), far(random), far(random), 0.0f);  // other cells each time
    auto cloud = random_cloud(model.vertex_count(), seed);
    for (glm::vec4& x : cloud) x += offset;
    check_against_brute_force(model, cloud);
  }
}

TEST_CASE("neighbour lists hold exactly the pairs that brute force finds on a folded cloth") {
  const auto context = test::context();
  const model::Model model = sheet_model(25);
  check_against_brute_force(model, folded(model));
}

TEST_CASE("neighbour lists are the same whatever the order of threads: nearest first, every time") {
  const auto context = test::context();
  const model::Model model = sheet_model(25);
  const auto at = random_cloud(model.vertex_count(), 4);
  Search search(model, at);
  const Lists first = search.run();
  for (std::uint32_t i = 0; i < at.size(); ++i)
    for (std::size_t slot = 1; slot < first[i].size(); ++slot) {
      const auto gap = [&](std::size_t s) {
        return glm::distance(glm::vec3(at[i]), glm::vec3(at[first[i][s].vertex]));
      };
      REQUIRE(gap(slot - 1) <= gap(slot) + 1e-6f);  // one rounding of a length below 1
    }
  for (int again = 0; again < 5; ++again) {
    search.self_collision.invalidate();
    REQUIRE(search.run() == first);
  }
}

TEST_CASE("neighbour lists do not depend on the numbering of the vertices") {
  const auto context = test::context();
  // Unconnected triangles: their vertices can be numbered otherwise without another order of springs.
  const auto cloud = random_cloud(300, 5);
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(6));

  model::Model model;
  model.rest_position.assign(cloud.size(), glm::dvec3(0.0));
  for (std::size_t i = 0; i < cloud.size(); ++i) model.rest_position[i].x = static_cast<double>(i);
  model.vertex_cloth.assign(cloud.size(), 0);
  model.contact_exclusions.offsets.assign(cloud.size() + 1, 0);
  model.cloths.push_back({0, static_cast<std::uint32_t>(cloud.size()), 0, 0, 0.05});
  std::vector<glm::vec4> shuffled(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) shuffled[order[i]] = cloud[i];

  const Lists plain = Search(model, cloud).run(), permuted = Search(model, shuffled).run();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::set<std::uint32_t> expected, found;
    for (const auto& neighbour : plain[i]) expected.insert(order[neighbour.vertex]);
    for (const auto& neighbour : permuted[order[i]]) found.insert(neighbour.vertex);
    REQUIRE(found == expected);
  }
}

TEST_CASE("vertices at the same place are neighbours and give no NaN") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(5, 5);
  scene.self_collision = scene::SelfCollision{thickness, 0.3};
  scene.cloths.push_back(scene.cloths[0]);  // the same cloth again, in the same place
  const auto simulation = test::simulation(scene);
  simulation->step(100);
  REQUIRE(simulation->diagnose().finite);
}

TEST_CASE("a contact distance far too large for the mesh is counted, not hidden") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(33, 33);
  scene.self_collision = scene::SelfCollision{thickness, 0.0};
  const auto fitting = test::simulation(scene);
  fitting->step(1);
  REQUIRE(fitting->diagnose().neighbours_dropped == 0);
  REQUIRE(fitting->diagnose().neighbour_rebuilds == 1);
  scene.self_collision->thickness = 0.3;
  const auto crowded = test::simulation(scene);
  crowded->step(1);
  REQUIRE(crowded->diagnose().neighbours_dropped > 0);
}

TEST_CASE("neighbour lists are rebuilt when a vertex has moved half the skin, and not before") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(25, 25);
  scene.self_collision = scene::SelfCollision{thickness, 0.0};
  const auto simulation = test::simulation(scene);
  // Free fall by half a skin, a mean edge: sqrt(0.5 * 0.0474 / 4.9) = 0.0696 s.
  simulation->step(65);
  REQUIRE(simulation->diagnose().neighbour_rebuilds == 1);
  simulation->step(10);
  REQUIRE(simulation->diagnose().neighbour_rebuilds == 2);
}

TEST_CASE("a sheet that falls on another one comes to lie a thickness above it") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(13, 13);
  scene.self_collision = scene::SelfCollision{0.02, 0.3};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform.translate.y = 1.05;
  for (const auto line : {scene::AtEdge::Line::row, scene::AtEdge::Line::column})
    for (const int index : {0, 12}) scene.cloths[0].pins.push_back({scene::AtEdge{line, index}, {}});
  scene.cloths[0].material = scene::Springs{200000.0, 100000.0, 20000.0, 2.0};
  scene.solver.dt = 0.0002;
  const auto simulation = test::simulation(scene);
  simulation->step(2500);
  const sim::State state = simulation->read_state();
  float lowest = 1e9f;
  for (std::size_t i = 0; i < 169; ++i)
    lowest = std::min(lowest, state.position[169 + i].y - state.position[i].y);
  // The layers lie vertex over vertex. Each pair is kept a thickness apart, less one step's fall before the
  // contact is seen.
  REQUIRE(lowest > 0.02f - 2e-4f);
  REQUIRE(simulation->diagnose().contacts > 100);
}

TEST_CASE("two free sheets that collide keep their momentum and gain no energy") {
  const auto context = test::context();
  scene::Scene scene = test::sheet(13, 13);
  scene.gravity = glm::dvec3(0.0);
  scene.self_collision = scene::SelfCollision{0.02, 0.3};
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform = {{0.013, 1.05, 0.021}, {3.0, 20.0, 0.0}, 1.0};  // askew: contacts of every kind
  const scene::AtBox everywhere{glm::dvec3(-10.0), glm::dvec3(10.0)};
  scene.cloths[1].pins = {{everywhere, scene::Linear{{0.3, -1.0, 0.2}}}};
  const auto simulation = test::simulation(scene);
  simulation->step(1);
  scene.cloths[1].pins.clear();  // let go: it flies on
  REQUIRE(simulation->change(scene));

  const auto momentum = [&] {
    glm::dvec3 sum(0.0);
    const sim::State state = simulation->read_state();
    for (const glm::vec3& v : state.velocity) sum += 0.1 * glm::dvec3(v);
    return sum;
  };
  const glm::dvec3 before = momentum();
  const double energy = simulation->diagnose().kinetic;
  REQUIRE(energy == Approx(0.5 * 16.9 * 1.13).epsilon(1e-4));
  std::uint32_t most_contacts = 0;
  for (int i = 0; i < 20; ++i) {
    simulation->step(10);
    const sim::Diagnostics now = simulation->diagnose();
    most_contacts = std::max(most_contacts, now.contacts);
    REQUIRE(now.kinetic + now.elastic < energy * 1.001);
  }
  REQUIRE(most_contacts > 20);
  // Rounding alone: |dp| / sum |m v| < 1e-5.
  REQUIRE(glm::length(momentum() - before) < 1e-5 * 16.9 * std::sqrt(1.13));
}

TEST_CASE("neighbour lists are built no more often where the scene has a mesh among its colliders") {
  const auto context = test::context();
  const auto rebuilds = [](bool with_mesh) {
    scene::Scene scene = test::sheet(17, 17);
    scene.self_collision = scene::SelfCollision{thickness, 0.0};
    scene::Transform far_away;
    far_away.translate = {0.0, -100.0, 0.0};
    if (with_mesh) scene.colliders = {test::body_of(test::ball_mesh(1), far_away)};
    const auto simulation = test::simulation(scene);
    simulation->step(100);
    return simulation->diagnose().neighbour_rebuilds;
  };
  const std::uint32_t without = rebuilds(false);
  REQUIRE(without < 50);  // else steps that build them anyway would hide it
  CHECK(rebuilds(true) == without);
}
