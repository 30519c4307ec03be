// A strip of finite elements that is clamped at one end and hangs over by its own weight, against the
// elastica: the beam that bends as far as it will and keeps its length. Gamma = weight an area x length^3 /
// bending stiffness.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "server/reference/rest_shape.h"
#include "tests/catch.h"
#include "tests/physics/stage.h"
#include "tests/small_scenes.h"

using namespace clothlab;

namespace {

/// Drop over reach of the elastica theta'' = -Gamma (1 - s) cos theta, theta(0) = 0, theta'(1) = 0. With w =
/// pi/2 - theta and u = 1 - s it is w'' = Gamma u sin w, integrated from the free end by RK4 in 4000 steps;
/// the angle w there is found by bisection of its logarithm: a limp strip's end is vertical to many digits.
/// (Beyond the angle that is sought there are solutions with loops.)
double elastica(double gamma) {
  const double quarter = std::acos(0.0);
  struct Run {
    double steepest, drop_over_reach;
  };
  const auto run = [&](double end_angle) {
    constexpr int steps = 4000;
    constexpr double h = 1.0 / steps;
    double w = end_angle, bend = 0.0, drop = 0.0, reach = 0.0, steepest = w;
    const auto slope = [&](double u, double angle) { return gamma * u * std::sin(angle); };
    for (int n = 0; n < steps; ++n) {
      const double u = n * h, k1 = bend, m1 = slope(u, w);
      const double k2 = bend + h / 2 * m1, m2 = slope(u + h / 2, w + h / 2 * k1);
      const double k3 = bend + h / 2 * m2, m3 = slope(u + h / 2, w + h / 2 * k2);
      const double k4 = bend + h * m3, m4 = slope(u + h, w + h * k3);
      const double before = w;
      w += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      bend += h / 6 * (m1 + 2 * m2 + 2 * m3 + m4);
      steepest = std::max(steepest, w);
      drop += h / 2 * (std::cos(before) + std::cos(w));
      reach += h / 2 * (std::sin(before) + std::sin(w));
    }
    return Run{steepest, drop / reach};
  };
  double low = -40.0, high = std::log(quarter);  // of the end's angle
  for (int n = 0; n < 80; ++n) {
    const double middle = 0.5 * (low + high);
    (run(std::exp(middle)).steepest > quarter ? high : low) = middle;
  }
  return run(std::exp(0.5 * (low + high))).drop_over_reach;
}

enum class Mesh { grid, other_diagonals, at_45_degrees, irregular };

constexpr double length = 0.2;  // [m], of the part that hangs over
constexpr int across = 2;       // cells

/// A strip along z with `cells` cells from z = 0 to its length, and one more before, which is clamped: all
/// vertices with z <= 0 are pinned.
scene::Scene strip(Mesh kind, int cells, const scene::Fem& material) {
  scene::Scene scene = test::bare_scene(scene::Method::implicit_euler, 1e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene::TriangleMesh mesh;
  const double h = length / cells;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> either(-0.3 * h, 0.3 * h);
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * (across + 1) + column);
  };
  for (int row = 0; row <= cells + 1; ++row)
    for (int column = 0; column <= across; ++column) {
      const bool moved = kind == Mesh::irregular && row > 1 && row <= cells && column > 0 && column < across;
      mesh.vertices.push_back(
          {column * h + (moved ? either(random) : 0.0), 0.0, (row - 1) * h + (moved ? either(random) : 0.0)});
    }
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column < across; ++column) {
      const auto a = at(column, row), b = at(column, row + 1), c = at(column + 1, row + 1),
                 d = at(column + 1, row);
      const bool other = kind == Mesh::other_diagonals || (kind == Mesh::irregular && random() % 2);
      if (kind == Mesh::at_45_degrees) {  // a vertex in the middle: squares that stand on their corners
        const auto m = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back({(column + 0.5) * h, 0.0, (row - 0.5) * h});
        for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, d}, {d, a}})
          mesh.triangles.push_back({p, q, m});
      } else if (other) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      }
    }
  scene::Cloth cloth;
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::area_density, 0.1};
  cloth.material = material;
  cloth.pins = {{scene::AtBox{{-1.0, -1.0, -1.0}, {1.0, 1.0, 1e-9}}, {}}};
  scene.cloths = {cloth};
  return scene;
}

/// Drop over reach of the free end.
double drop_over_reach(const scene::Scene& scene, int cells) {
  reference::World world = world_of(scene);
  // In steps of gravity, each from the shape of the one before: a strip that falls by its full weight at once
  // has other balances on its way.
  std::vector<glm::dvec3> shape = world.model.rest_position;
  for (const double share : {0.03, 0.1, 0.3, 1.0}) {
    world.scene.gravity = share * scene.gravity;
    const Result<reference::RestShape> found = reference::rest_shape(world, shape, {});
    INFO((found ? "" : found.error().text()));
    REQUIRE(found);
    shape = found->position;
  }
  double drop = 0.0, reach = 0.0;
  for (int column = 0; column <= across; ++column) {
    const glm::dvec3& end = shape[static_cast<std::size_t>((cells + 1) * (across + 1) + column)];
    drop -= end.y;
    reach += end.z;
  }
  return drop / reach;
}

scene::Fem sheet(double bending) {
  scene::Fem fem;
  fem.warp = fem.weft = 2000;
  fem.poisson = 0.3;
  fem.shear = 770;
  fem.bending = {bending, bending, std::nullopt};
  return fem;
}

double stiffness_of(double gamma) {
  return 0.1 * 9.81 * length * length * length / gamma;
}

}  // namespace

TEST_CASE("the elastica's drop over reach is that of a beam where it is stiff: Gamma / 8 and little more") {
  CHECK(elastica(0.01) == Approx(0.01 / 8).epsilon(1e-4));
  CHECK(elastica(1.0) == Approx(0.1246).epsilon(1e-3));  // found with a boundary value solver, too
  CHECK(elastica(100.0) == Approx(5.888).epsilon(1e-3));
  CHECK(elastica(1000.0) == Approx(21.335).epsilon(1e-3));
}

TEST_CASE("a cantilever strip hangs like the elastica within 5 % on every mesh, at two resolutions") {
  for (const Mesh kind : {Mesh::grid, Mesh::other_diagonals, Mesh::at_45_degrees, Mesh::irregular})
    for (const double gamma : {1.0, 10.0, 100.0, 1000.0})
      for (const double fineness : {1.0, 1.25}) {
        const bool alike = kind == Mesh::other_diagonals || kind == Mesh::at_45_degrees;
        if (!test::thorough() && (alike || (fineness > 1.0 && gamma != 10.0))) continue;
        // The limpest strip needs 90 cells, and most of the time: once, on the two meshes least like a grid.
        if (gamma == 1000.0 && (fineness > 1.0 || kind == Mesh::grid || kind == Mesh::other_diagonals))
          continue;
        // At the clamp the strip bends to a radius of length / sqrt(2 Gamma): an edge is at most half of
        // that.
        const int cells =
            static_cast<int>(std::lround(fineness * std::max(20.0, std::ceil(2 * std::sqrt(2 * gamma)))));
        const double found = drop_over_reach(strip(kind, cells, sheet(stiffness_of(gamma))), cells);
        const double exact = elastica(gamma);
        INFO("mesh " << static_cast<int>(kind) << ", " << cells << " cells, Gamma " << gamma << ": " << found
                     << ", elastica " << exact << ", off by " << 100 * (found / exact - 1) << " %");
        CHECK(std::abs(found / exact - 1) < 0.05);
      }
}

TEST_CASE(
    "along the warp and along the weft a strip bends by the stiffness of its own direction, on every mesh") {
  const double gamma = 10.0;
  for (const Mesh kind : {Mesh::grid, Mesh::other_diagonals, Mesh::at_45_degrees, Mesh::irregular}) {
    INFO("mesh " << static_cast<int>(kind));
    scene::Fem fem = sheet(stiffness_of(gamma));
    fem.bending.warp = 3 * fem.bending.weft;  // the strip hangs along z, the grid's weft
    CHECK(drop_over_reach(strip(kind, 20, fem), 20) == Approx(elastica(gamma)).epsilon(0.05));
    fem.grain = 90.0;
    CHECK(drop_over_reach(strip(kind, 20, fem), 20) == Approx(elastica(gamma / 3)).epsilon(0.05));
    // Cut at 45 degrees a narrow strip may twist as well as bend: it is as limp as if each of the three
    // resisted alone, 1/B = (1/B_warp + 1/B_weft + 1/T) / 4.
    fem.grain = 45.0;
    fem.bending.twist = fem.bending.weft;
    CHECK(drop_over_reach(strip(kind, 20, fem), 20) ==
          Approx(elastica(gamma * (1.0 / 3 + 1 + 1) / 4)).epsilon(0.05));
  }
}
