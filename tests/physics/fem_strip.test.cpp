// Strips of finite elements in balance: pulled off their grain, and pressed until they buckle.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/reference/rest_shape.h"
#include "tests/catch.h"
#include "tests/physics/stage.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using glm::dvec2;
using glm::dvec3;

namespace {

const double pi = std::acos(-1.0);

std::vector<dvec3> shape_of(const reference::World& world, std::vector<dvec3> start) {
  const auto found = reference::rest_shape(world, std::move(start), {});
  INFO((found ? "" : found.error().text()));
  REQUIRE(found);
  return found->position;
}

}  // namespace

TEST_CASE("a long strip that is hung off its grain stretches in its middle as its modulus there says") {
  constexpr int columns = 5, rows = 41;
  constexpr double width = 0.1, height = 1.0, warp = 90, weft = 60, poisson = 0.3, shear = 15;
  for (const double grain : {0.0, 30.0, 60.0, 90.0}) {
    scene::Scene scene = test::bare_scene(scene::Method::implicit_euler, 1e-3);
    scene.gravity = {0.0, 0.0, 9.81};
    scene::Cloth& cloth = scene.cloths.emplace_back();
    cloth.mesh = scene::Grid{columns, rows, width, height};
    cloth.mass = {scene::Mass::Kind::area_density, 1e-5};
    cloth.material = scene::Fem{warp, weft, poisson, shear, {1e-5, 1e-5, std::nullopt}, 0, grain, {}};
    cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
    constexpr double load = 0.4;  // [N] in all
    cloth.weights = {{scene::AtEdge{scene::AtEdge::Line::row, rows - 1}, load / 9.81 / columns}};
    const reference::World world = world_of(scene);
    const auto shape = shape_of(world, world.model.rest_position);
    const auto middle = [&](int row) { return shape[static_cast<std::size_t>(row * columns + columns / 2)]; };
    // Off the grain its ends are uneven for a width or two, so the middle third alone is looked at.
    const double along = glm::distance(middle(13), middle(27)) / (14 * height / (rows - 1));
    // From the warp, at `grain` from the rows, to the pull along the columns.
    const double a = (90 - grain) * pi / 180, c2 = std::cos(a) * std::cos(a), s2 = 1 - c2;
    const double modulus = 1 / (c2 * c2 / warp + s2 * s2 / weft + (1 / shear - 2 * poisson / warp) * c2 * s2);
    const double tension = modulus * along * (along * along - 1) / 2;
    INFO("grain " << grain << ": stretched by " << along - 1 << ", modulus " << modulus);
    CHECK(along > 1.03);
    // What the ends disturb dies away by e^-2 pi a width in an isotropic strip, here by half of that exponent
    // (the square root of shear over modulus): e^-9 over the three widths. The rest is of the mesh.
    CHECK(tension == Approx(load / width).epsilon(0.01));
  }
}

namespace {

constexpr double length = 0.2, modulus = 100.0, bending = 4e-4;  // [m], [N/m], [N m]
constexpr int cells = 24, across = 2;

/// A strip whose ends are held nearer to each other than its pattern is long, by the share `pressed`: as on
/// hinges, by one row of pins each.
reference::World pressed_strip(double pressed, bool other_diagonals) {
  scene::Scene scene = test::bare_scene(scene::Method::implicit_euler, 1e-3);
  scene::TriangleMesh mesh;
  const double h = length / cells;
  std::vector<dvec2> flat;
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= across; ++column) {
      flat.emplace_back(column * h, row * h);
      mesh.vertices.push_back({column * h, 0.0, row * h * (1 - pressed)});
    }
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < across; ++column) {
      const auto a = static_cast<std::uint32_t>(row * (across + 1) + column), b = a + 1, d = a + across + 1,
                 c = d + 1;
      const auto add = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        mesh.triangles.push_back({i, j, k});
        mesh.pattern.push_back({flat[i], flat[j], flat[k]});
      };
      if (other_diagonals)
        add(a, d, b), add(b, d, c);
      else
        add(a, d, c), add(a, c, b);
    }
  scene::Cloth cloth;
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::area_density, 0.1};
  cloth.material = scene::Fem{modulus, modulus, 0.0, modulus / 2, {bending, bending, std::nullopt}, 0, 0, {}};
  const double end = length * (1 - pressed);
  cloth.pins = {{scene::AtBox{{-1, -1, -1}, {1, 1, 1e-9}}, {}},
                {scene::AtBox{{-1, -1, end - 1e-9}, {1, 1, end + 1e-9}}, {}}};
  scene.cloths = {cloth};
  return world_of(scene);
}

/// How far the strip's middle leaves the plane, begun with a hint of it [m].
double buckled(const reference::World& world) {
  std::vector<dvec3> start = world.model.rest_position;
  const double end = start.back().z;
  for (dvec3& x : start) x.y = 1e-3 * std::sin(pi * x.z / end);
  const auto shape = shape_of(world, start);
  return shape[static_cast<std::size_t>(cells / 2 * (across + 1) + across / 2)].y;
}

}  // namespace

TEST_CASE("a strip on hinges buckles at Euler's load, pi^2 B / L^2, and not below it") {
  // Pressed by the share e its load is Y e, until it buckles.
  const double critical = pi * pi * bending / (length * length) / modulus;
  CHECK(critical == Approx(9.87e-4).epsilon(1e-3));
  for (const bool other : {false, true}) {
    CHECK(std::abs(buckled(pressed_strip(0.95 * critical, other))) < 1e-5);
    for (const double over : {1.2, 1.5}) {
      // Beyond it the load stays, and a sine of amplitude a shortens the strip by (pi a / 2 L)^2.
      const double amplitude = buckled(pressed_strip(over * critical, other));
      const double at = over * critical - std::pow(pi * amplitude / (2 * length), 2);
      INFO("pressed by " << over << " of Euler's load: amplitude " << amplitude << " m, load "
                         << at / critical);
      CHECK(amplitude > 1e-3);
      // The mesh's own load is (pi h / L)^2 / 12 = 0.14 % lower; strains squared are 0.15 % of the load; the
      // sine is a sine to the square of its slope, 0.1 %.
      CHECK(at == Approx(critical).epsilon(0.01));
    }
  }
}
