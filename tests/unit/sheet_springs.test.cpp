// Stiffnesses of the springs of triangle meshes.
#include "server/model/sheet_springs.h"

#include <algorithm>

#include "server/model/model.h"
#include "tests/catch.h"
#include "tests/sheets.h"

using namespace clothlab;
using test::Cut;

namespace {

constexpr scene::Springs isotropic{200.0, 100.0, 0.0, 0.0};  // a grid of these is as stiff in all directions

model::Model built(const scene::Scene& scene) {
  return *model::build(scene);
}

scene::Scene scene_with(const scene::TriangleMesh& mesh, const scene::Springs& springs) {
  scene::Scene scene = test::sheet_of(Cut::one_diagonal, 2, springs);
  scene.cloths[0].mesh = mesh;
  return scene;
}

}  // namespace

TEST_CASE("a grid's triangles get the grid's springs, half as stiff along the border") {
  constexpr int cells = 8, n = cells + 1;
  for (const Cut cut : {Cut::one_diagonal, Cut::other_diagonal}) {
    const model::Model model = built(test::sheet_of(cut, cells, isotropic));
    for (const model::Spring& spring : model.springs()) {
      const auto column = [](std::uint32_t i) { return static_cast<int>(i) % n; };
      const auto row = [](std::uint32_t i) { return static_cast<int>(i) / n; };
      const auto [a, b] = spring.vertices;
      const int across = std::abs(column(a) - column(b)), down = row(b) - row(a);
      INFO(column(a) << "," << row(a) << " - " << column(b) << "," << row(b));
      // Two vertices from the border: there the corners of the sheet, which have one triangle or two, count.
      const int edge = std::min({column(a), row(a), column(b), row(b), cells - column(a), cells - row(a),
                                 cells - column(b), cells - row(b)});
      if (edge < 2) continue;
      CHECK(std::max(across, down) == 1);
      // Springs that would be equal in an endless grid differ by how far the solution of least squares is.
      CHECK(spring.law.stiffness == Approx(across + down == 1 ? 200.0 : 100.0).epsilon(0.01));
    }
  }
}

TEST_CASE("the same sheet gives way alike however it is cut into triangles, and like a grid") {
  // The border of a grid of n cells has springs for a half cell more: (n + 1)/n as stiff along it, and more
  // where only a quarter of a side is held.
  constexpr int cells = 10;
  constexpr double border = 1.0 / cells;
  std::vector<test::Load> loads = test::loads(9.8);
  loads.pop_back();  // sags are in tests/bench/triangulations.cpp: they depend least on the cut
  for (const test::Load& load : loads) {
    const bool at_a_corner = load.held.size() == 2 && load.gravity.z != 0.0;
    const double grid = test::yielding(test::sheet_of(Cut::grid, cells, isotropic), load);
    const double triangles = test::yielding(test::sheet_of(Cut::one_diagonal, cells, isotropic), load);
    INFO(load.name);
    CHECK(triangles > grid);
    CHECK(triangles < (1.0 + (at_a_corner ? 1.5 : 1.0) * border) * grid);
    for (const Cut cut : test::all_cuts) {
      if (cut == Cut::grid) continue;
      INFO(test::name_of(cut));
      // Lines of tension bend in irregular meshes, whose springs cannot all be balanced: that makes them
      // softer. Without stiffnesses of their own, diagonals of one direction would make this a factor of 3.
      CHECK(test::yielding(test::sheet_of(cut, cells, isotropic), load) / triangles ==
            Approx(1.0).margin(cut == Cut::irregular ? 0.1 : 0.05));
    }
  }
}

TEST_CASE("springs of a mesh do not depend on its size, and are proportional to the material's numbers") {
  const auto mesh =
      std::get<scene::TriangleMesh>(test::sheet_of(Cut::irregular, 6, isotropic).cloths[0].mesh);
  scene::TriangleMesh large = mesh;
  for (glm::dvec3& vertex : large.vertices) vertex *= 1000.0;
  const scene::Springs soft{200.0, 100.0, 20.0, 2.0}, hard{2000.0, 1000.0, 200.0, 20.0};
  const model::Model a = built(scene_with(mesh, soft)), b = built(scene_with(large, hard));
  REQUIRE(a.springs().size() == b.springs().size());
  for (std::size_t i = 0; i < a.springs().size(); ++i) {
    CHECK(a.springs()[i].vertices == b.springs()[i].vertices);
    CHECK(b.springs()[i].law.stiffness == Approx(10.0 * a.springs()[i].law.stiffness).epsilon(1e-9));
    CHECK(b.springs()[i].law.damping == Approx(10.0 * a.springs()[i].law.damping).epsilon(1e-9));
  }
}

TEST_CASE(
    "slivers, obtuse triangles, triangles without area and edges without length get stiffnesses within "
    "bounds") {
  scene::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 1e-6},  {0.4, 0, -0.01},
                   {2, 0, 0}, {2, 0, 0}, {0.5, 0.3, -0.2}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 4, 5}, {0, 3, 6}, {1, 6, 3}};
  scene::Scene scene = scene_with(mesh, {200.0, 100.0, 20.0, 1.0});
  scene.cloths[0].mass = {scene::Mass::Kind::per_vertex, 0.01};
  const model::Model model = built(scene);
  constexpr double modulus = (200.0 + 2 * 100.0 + 4 * 20.0) / 4;
  CHECK(model.springs().size() >= 10);
  for (const auto& [a, b] : {std::pair{0u, 1u}, {0u, 2u}, {1u, 2u}, {1u, 4u}, {4u, 5u}}) {
    const auto found = std::find_if(model.springs().begin(), model.springs().end(), [&](const auto& spring) {
      return spring.vertices[0] == a && spring.vertices[1] == b;
    });
    INFO(a << " - " << b);
    REQUIRE(found != model.springs().end());
    CHECK(found->law.stiffness >= 0.05 * modulus);
  }
  for (const model::Spring& spring : model.springs()) {
    INFO(spring.vertices[0] << " - " << spring.vertices[1]);
    CHECK(spring.law.stiffness >= 0.0);
    CHECK(spring.law.stiffness <= 8.0 * modulus * (1 + 1e-12));
  }
}

TEST_CASE("a mesh without stiffness has no springs, and one with any of the three has some") {
  for (const scene::Springs& springs :
       {scene::Springs{5, 0, 0, 0}, scene::Springs{0, 5, 0, 0}, scene::Springs{0, 0, 5, 0}})
    CHECK(built(test::sheet_of(Cut::irregular, 4, springs)).springs().size() > 0);
  CHECK(built(test::sheet_of(Cut::irregular, 4, {0, 0, 0, 1})).springs().empty());
}
