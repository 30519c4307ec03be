// Colours of springs and vertices, on grids and on random meshes.
#include "server/model/colouring.h"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "tests/catch.h"

using namespace clothlab;

namespace {

scene::Scene scene_of(scene::Mesh mesh) {
  scene::Scene scene;
  scene.cloths.resize(1);
  scene.cloths[0].mesh = std::move(mesh);
  return scene;
}

/// A strip of triangles over random points, with a few fans, so that vertices have from 2 to many springs.
scene::TriangleMesh random_mesh(std::uint32_t seed, std::uint32_t vertices) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  scene::TriangleMesh mesh;
  for (std::uint32_t i = 0; i < vertices; ++i)
    mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
  for (std::uint32_t i = 2; i < vertices; ++i) {
    const std::uint32_t hub = random() % 5 == 0 ? 0 : i - 2;
    if (hub != i - 1) mesh.triangles.push_back({hub, i - 1, i});
  }
  return mesh;
}

/// Checks that every item is there once, offsets rise, and items rise within each colour.
void check_partition(const model::Colouring& colouring, std::size_t count) {
  REQUIRE(colouring.order.size() == count);
  CHECK(std::set<std::uint32_t>(colouring.order.begin(), colouring.order.end()).size() == count);
  REQUIRE(colouring.offsets.front() == 0);
  REQUIRE(colouring.offsets.back() == count);
  for (std::uint32_t c = 0; c < colouring.colours(); ++c) {
    const auto first = colouring.order.begin() + colouring.offsets[c],
               last = colouring.order.begin() + colouring.offsets[c + 1];
    CHECK(first < last);
    CHECK(std::is_sorted(first, last));
  }
}

std::vector<std::uint32_t> colour_of_each(const model::Colouring& colouring) {
  std::vector<std::uint32_t> colour(colouring.order.size());
  for (std::uint32_t c = 0; c < colouring.colours(); ++c)
    for (std::uint32_t k = colouring.offsets[c]; k < colouring.offsets[c + 1]; ++k)
      colour[colouring.order[k]] = c;
  return colour;
}

void check_springs(const model::Model& model, const model::Colouring& colouring) {
  check_partition(colouring, model.springs().size());
  const std::vector<std::uint32_t> colour = colour_of_each(colouring);
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;  // (colour, vertex)
  for (std::size_t i = 0; i < model.springs().size(); ++i)
    for (const std::uint32_t vertex : model.springs()[i].vertices)
      CHECK(seen.insert({colour[i], vertex}).second);
}

void check_vertices(const model::Model& model, const model::Colouring& colouring) {
  check_partition(colouring, model.vertex_count());
  const std::vector<std::uint32_t> colour = colour_of_each(colouring);
  for (const model::Spring& spring : model.springs())
    CHECK(colour[spring.vertices[0]] != colour[spring.vertices[1]]);
}

}  // namespace

TEST_CASE("a grid's springs take 12 colours, its vertices 5, and no two neighbours the same") {
  for (const auto& [columns, rows] : {std::pair{25, 25}, {5, 41}, {7, 4}, {30, 3}}) {
    const scene::Scene scene = scene_of(scene::Grid{columns, rows, 1.0, 1.0});
    const model::Model model = *model::build(scene);
    const model::Colouring springs = model::colour_elements(model, scene)[0];
    check_springs(model, springs);
    CHECK(springs.colours() <= 12);
    if (columns > 4 && rows > 4) CHECK(springs.colours() == 12);
    const model::Colouring vertices = model::colour_vertices(model, scene);
    check_vertices(model, vertices);
    CHECK(vertices.colours() == 5);
  }
}

TEST_CASE("kinds of springs that a grid lacks take no colour") {
  scene::Scene scene = scene_of(scene::Grid{9, 9, 1.0, 1.0});
  scene.cloths[0].springs().bend = scene.cloths[0].springs().shear = 0.0;
  const model::Model model = *model::build(scene);
  const model::Colouring springs = model::colour_elements(model, scene)[0];
  check_springs(model, springs);
  CHECK(springs.colours() == 4);
}

TEST_CASE("random meshes are coloured validly, within the bounds of greedy colouring") {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const scene::Scene scene = scene_of(random_mesh(seed, 10 + 13 * seed));
    const model::Model model = *model::build(scene);
    std::uint32_t most = 0;
    for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
      most = std::max(most, model.springs().at_vertex.offsets[i + 1] - model.springs().at_vertex.offsets[i]);
    const model::Colouring springs = model::colour_elements(model, scene)[0];
    check_springs(model, springs);
    CHECK(springs.colours() >= most);      // springs at one vertex have different colours
    CHECK(springs.colours() <= 2 * most);  // a spring has at most 2 (most - 1) neighbours
    const model::Colouring vertices = model::colour_vertices(model, scene);
    check_vertices(model, vertices);
    CHECK(vertices.colours() <= most + 1);
  }
}

TEST_CASE("a grid whose elements the five colours do not fit gets others") {
  constexpr std::uint32_t columns = 6;
  const scene::Scene scene = scene_of(scene::Grid{columns, 5, 1.0, 1.0});
  model::Model model = *model::build(scene);
  model::Batch<elements::Spring>& springs = model.elements.of<elements::Spring>();
  // (column + 2 row) mod 5 is the same one column and two rows further.
  springs[0].vertices = {0, 1 + 2 * columns};
  model::Adjacency& at_vertex = springs.at_vertex;
  at_vertex.items.clear();
  for (std::uint32_t vertex = 0; vertex < model.vertex_count(); ++vertex) {
    at_vertex.offsets[vertex] = static_cast<std::uint32_t>(at_vertex.items.size());
    for (std::uint32_t i = 0; i < springs.size(); ++i)
      for (std::uint32_t corner = 0; corner < 2; ++corner)
        if (springs[i].vertices[corner] == vertex) at_vertex.items.push_back(2 * i + corner);
  }
  check_vertices(model, model::colour_vertices(model, scene));
}

TEST_CASE("several cloths are coloured together, and the same way every time") {
  scene::Scene scene = scene_of(scene::Grid{6, 5, 1.0, 1.0});
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].mesh = random_mesh(3, 40);
  const model::Model model = *model::build(scene);
  const model::Colouring springs = model::colour_elements(model, scene)[0];
  const model::Colouring vertices = model::colour_vertices(model, scene);
  check_springs(model, springs);
  check_vertices(model, vertices);
  CHECK(model::colour_elements(model, scene)[0].order == springs.order);
  CHECK(model::colour_vertices(model, scene).order == vertices.order);
}

TEST_CASE("greedy colours are balanced: the largest has at most half as many members again as the mean") {
  const scene::Scene scene = scene_of(random_mesh(5, 600));
  const model::Model model = *model::build(scene);
  for (const model::Colouring& colouring :
       {model::colour_vertices(model, scene), model::colour_elements(model, scene)[0]}) {
    const double mean = static_cast<double>(colouring.order.size()) / colouring.colours();
    for (std::uint32_t c = 0; c < colouring.colours(); ++c)
      CHECK(colouring.offsets[c + 1] - colouring.offsets[c] <= 1.5 * mean);
  }
}
