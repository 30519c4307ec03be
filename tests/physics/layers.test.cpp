// Layers of cloth that meet: the thickness from which vertices that keep apart keep their surfaces apart.
#include "server/model/thickness.h"
#include "tests/crossings.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

/// A cloth that falls onto another one, which is held at two edges. The first is turned by this many degrees;
/// at 0 all of its vertices lie over middles of the other's cells.
scene::Scene falling_sheet(double degrees) {
  constexpr double half_cell = 0.2 / 12;
  scene::Scene scene;
  for (const bool upper : {false, true}) {
    scene::Cloth& cloth = scene.cloths.emplace_back();
    cloth.mesh = scene::Grid{13, 13, 0.4, 0.4};
    cloth.transform.translate = {0.0, 0.05, -0.2};
    if (upper) cloth.transform = {{half_cell, 0.15, half_cell - 0.2}, {0.0, degrees, 0.0}, 1.0};
    cloth.mass = {scene::Mass::Kind::per_vertex, 0.0007};
    cloth.material = scene::Springs{300.0, 150.0, 20.0, 0.02};
  }
  for (const int row : {0, 12})
    scene.cloths[0].pins.push_back({scene::AtEdge{scene::AtEdge::Line::row, row}, {}});
  scene.air_drag = 0.3;
  scene.solver.dt = 5e-4;
  return scene;
}

/// Largest number of crossings at any of 30 times in 1.5 s.
std::size_t most_crossings(const scene::Scene& scene) {
  const auto simulation = test::simulation(scene);
  std::size_t most = 0;
  for (int sample = 0; sample < 30; ++sample) {
    simulation->step(static_cast<std::uint32_t>(0.05 / scene.solver.dt));
    most = std::max(most, test::crossings(simulation->model(), simulation->read_state().position).size());
  }
  return most;
}

}  // namespace

TEST_CASE(
    "layers that meet gently do not pass through each other from the thickness that holds on, and below it "
    "do") {
  const auto context = test::context();
  for (const double degrees : {0.0, 45.0}) {
    scene::Scene scene = falling_sheet(degrees);
    const double holds = model::least_safe_thickness(*model::build(scene));
    INFO(degrees << " degrees, " << holds << " m holds");
    scene.self_collision = scene::SelfCollision{holds, 0.2};
    CHECK(most_crossings(scene) == 0);
    // Below half the diagonal of a cell a vertex passes through the cell's middle, far enough from all four
    // corners.
    scene.self_collision->thickness = holds / 1.3;
    CHECK(most_crossings(scene) > 0);
  }
}

TEST_CASE("crossings are those of edges through the inside of triangles that share no vertex with them") {
  const glm::dvec3 a(0, 0, 0), b(1, 0, 0), c(0, 0, 1);
  CHECK(test::crosses({0.2, -1, 0.2}, {0.2, 1, 0.2}, a, b, c));
  CHECK(test::crosses({0.2, 1, 0.2}, {0.2, -1, 0.2}, a, b, c));
  CHECK_FALSE(test::crosses({0.2, 0.1, 0.2}, {0.2, 1, 0.2}, a, b, c));  // ends before
  CHECK_FALSE(test::crosses({0.7, -1, 0.7}, {0.7, 1, 0.7}, a, b, c));   // passes beside it
  CHECK_FALSE(test::crosses({0.2, 0, 0.2}, {0.2, 1, 0.2}, a, b, c));    // only touches
}
