// A whole sheet of finite elements, as a scene makes it, against closed forms: the patch test, pulling and
// shearing along the grain and off it, bending off it, and what a rigid rotation feels.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <random>

#include "server/reference/rest_shape.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using glm::dmat2;
using glm::dvec2;
using glm::dvec3;

namespace {

/// MacNeal & Harder's (1985) patch: a rectangle of 0.24 x 0.12 m with four vertices inside, out of line, its
/// quadrilaterals cut into triangles.
constexpr std::array<std::array<double, 2>, 8> patch_place{
    {{0, 0}, {0.24, 0}, {0.24, 0.12}, {0, 0.12}, {0.04, 0.02}, {0.18, 0.03}, {0.16, 0.08}, {0.08, 0.08}}};
constexpr std::array<std::array<std::uint32_t, 3>, 10> patch_triangles{{{0, 1, 5},
                                                                        {0, 5, 4},
                                                                        {1, 2, 6},
                                                                        {1, 6, 5},
                                                                        {2, 3, 7},
                                                                        {2, 7, 6},
                                                                        {3, 0, 4},
                                                                        {3, 4, 7},
                                                                        {4, 5, 6},
                                                                        {4, 6, 7}}};

/// Their field: u = 1e-3 (x + y/2), v = 1e-3 (y + x/2).
dvec3 displaced(double x, double y) {
  return {x + 1e-3 * (x + y / 2), y + 1e-3 * (y + x / 2), 0.0};
}

/// The patch, its outer vertices held where the field puts them, its inner ones begun somewhere else. Modulus
/// 1e6 and thickness 0.001: 1000 N/m.
scene::Scene macneal_harder(scene::Method method) {
  scene::Scene scene = test::bare_scene(method, 0.01);
  scene::TriangleMesh mesh;
  scene::Cloth cloth;
  for (std::uint32_t i = 0; i < patch_place.size(); ++i) {
    const auto [x, y] = patch_place[i];
    mesh.vertices.push_back(displaced(x, y) + (i < 4 ? dvec3(0.0) : dvec3(0.004, -0.003, 0.002)));
    if (i < 4) cloth.pins.push_back({scene::AtVertex{i}, {}});
  }
  for (const auto& [a, b, c] : patch_triangles) {
    mesh.triangles.push_back({a, b, c});
    const auto at = [&](std::uint32_t i) { return dvec2(patch_place[i][0], patch_place[i][1]); };
    mesh.pattern.push_back({at(a), at(b), at(c)});
  }
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::per_vertex, 1e-3};
  cloth.material = scene::Fem{1000, 1000, 0.25, 400, {1e-5, 1e-5, std::nullopt}, 0.01, 0, std::nullopt};
  scene.cloths = {cloth};
  return scene;
}

/// A sheet of cotton on a grid, 0.3 x 0.2 m, in the x-z plane.
constexpr int columns = 7, rows = 6;
constexpr double width = 0.3, height = 0.2, warp = 2365, weft = 3801, poisson = 0.311, shear = 97;
constexpr double bend_warp = 8e-6, bend_weft = 12e-6, twist = 6e-6;
scene::Scene cotton(double grain, scene::Method method = scene::Method::symplectic_euler) {
  scene::Scene scene = test::bare_scene(method, 1e-4);
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{columns, rows, width, height};
  cloth.mass = {scene::Mass::Kind::area_density, 0.1};
  cloth.material = scene::Fem{warp, weft, poisson, shear, {bend_warp, bend_weft, twist}, 0.002, grain, {}};
  return scene;
}

/// The sheet's places under the gradient F of a plane deformation, in coordinates x, z.
std::vector<dvec3> deformed(const reference::World& world, const dmat2& gradient) {
  std::vector<dvec3> place;
  for (const dvec3& x : world.model.rest_position) {
    const dvec2 to = gradient * dvec2(x.x, x.z);
    place.emplace_back(to.x, 0.0, to.y);
  }
  return place;
}

std::vector<dvec3> forces(const reference::World& world, const std::vector<dvec3>& place) {
  return reference::element_forces(world, place, std::vector<dvec3>(place.size(), dvec3(0.0)));
}

/// The sheet's stiffness as a tensor of fourth order in the grid's axes, turned by the grain.
struct Stiffness {
  double c[2][2][2][2] = {};
  explicit Stiffness(double grain) {
    const double d = 1 - poisson * poisson * weft / warp, a = grain * std::acos(-1.0) / 180;
    double of_threads[2][2][2][2] = {};
    of_threads[0][0][0][0] = warp / d;
    of_threads[1][1][1][1] = weft / d;
    of_threads[0][0][1][1] = of_threads[1][1][0][0] = poisson * weft / d;
    of_threads[0][1][0][1] = of_threads[1][0][1][0] = of_threads[0][1][1][0] = of_threads[1][0][0][1] = shear;
    const double axis[2][2] = {{std::cos(a), std::sin(a)}, {-std::sin(a), std::cos(a)}};  // warp, weft
    for (int n = 0; n < 256; ++n) {
      const int i = n & 1, j = n >> 1 & 1, k = n >> 2 & 1, l = n >> 3 & 1;
      const int p = n >> 4 & 1, q = n >> 5 & 1, r = n >> 6 & 1, s = n >> 7 & 1;
      c[i][j][k][l] += axis[p][i] * axis[q][j] * axis[r][k] * axis[s][l] * of_threads[p][q][r][s];
    }
  }
  /// Second Piola-Kirchhoff stress, a metre of width [N/m].
  dmat2 stress(const dmat2& gradient) const {
    const dmat2 strain = 0.5 * (glm::transpose(gradient) * gradient - dmat2(1.0));
    dmat2 result(0.0);
    for (int n = 0; n < 16; ++n)
      result[n & 1][n >> 1 & 1] +=
          c[n & 1][n >> 1 & 1][n >> 2 & 1][n >> 3 & 1] * strain[n >> 2 & 1][n >> 3 & 1];
    return result;
  }
};

/// The gradient without rotation whose strain is uniaxial tension's along the grid's first axis, and has the
/// length `along` there.
dmat2 pulled(double grain, double along) {
  const double a = grain * std::acos(-1.0) / 180, c = std::cos(a), s = std::sin(a);
  // Strain of a stress of 1 along x, seen from warp and weft, which are turned by the grain.
  const double of_warp = c * c / warp - s * s * poisson / warp,
               of_weft = s * s / weft - c * c * poisson / warp;
  const double slant = -c * s / (2 * shear);  // half of the change of angle
  // The same, seen from the grid.
  const double xx = c * c * of_warp + s * s * of_weft - 2 * c * s * slant;
  const double zz = s * s * of_warp + c * c * of_weft + 2 * c * s * slant;
  const double xz = c * s * (of_warp - of_weft) + (c * c - s * s) * slant;
  const double stress = 0.5 * (along * along - 1) / xx;
  const dmat2 squared(1 + 2 * stress * xx, 2 * stress * xz, 2 * stress * xz, 1 + 2 * stress * zz);
  const double root = std::sqrt(glm::determinant(squared));
  return (1 / std::sqrt(squared[0][0] + squared[1][1] + 2 * root)) * (squared + dmat2(root));
}

}  // namespace

TEST_CASE(
    "the patch test: on a distorted mesh a linear field is the balance, with the same stress everywhere") {
  const reference::World world = world_of(macneal_harder(scene::Method::implicit_euler));
  const auto shape = reference::rest_shape(world);
  INFO((shape ? "" : shape.error().text()));
  REQUIRE(shape);
  for (std::size_t i = 0; i < patch_place.size(); ++i)
    CHECK(glm::distance(shape->position[i], displaced(patch_place[i][0], patch_place[i][1])) < 1e-9);
  for (const auto& element : world.model.elements.of<elements::Membrane>()) {
    const auto gradient = elements::gradient(element.law, edges(element, 0, shape->position));
    const dvec3 stress = elements::membrane_stress(element.law, elements::green_strain(gradient));
    const double area = 0.5 / (element.law.first_warp * element.law.second_weft -
                               element.law.first_weft * element.law.second_warp);
    // sigma = 1333.33 and tau = 400, times the thickness of 0.001. The strain's square adds up to 6.3e-4.
    CHECK(stress.x / area == Approx(1.33333).epsilon(7e-4));
    CHECK(stress.y / area == Approx(1.33333).epsilon(7e-4));
    CHECK(stress.z / area == Approx(0.4).epsilon(1.3e-3));
    // With it, exactly: E = (1e-3 + 0.625e-6) in both directions, slanted by 1e-3 + 1e-6.
    CHECK(stress.x / area == Approx(1000 / 0.75 * (1e-3 + 0.625e-6)).epsilon(1e-7));
    CHECK(stress.z / area == Approx(400 * (1e-3 + 1e-6)).epsilon(1e-7));
  }
}

TEST_CASE(
    "pulled along its grain or 30 degrees off it, a sheet's tension is Y l (l^2 - 1) / 2 of that direction") {
  for (const double grain : {0.0, 90.0, 30.0, -30.0, 60.0})
    for (const double along : {1.1, 1.01, 0.99}) {
      const reference::World world = world_of(cotton(grain));
      const dmat2 gradient = pulled(grain, along);
      const auto force = forces(world, deformed(world, gradient));
      const double a = grain * std::acos(-1.0) / 180, c2 = std::cos(a) * std::cos(a), s2 = 1 - c2;
      const double modulus =
          1 / (c2 * c2 / warp + s2 * s2 / weft + (1 / shear - 2 * poisson / warp) * c2 * s2);
      const dvec2 pull = gradient * dvec2(1.0, 0.0);
      CHECK(glm::length(pull) == Approx(along).epsilon(1e-12));
      INFO("grain " << grain << ", pulled to " << along << ", modulus " << modulus);
      dvec3 last(0.0);
      for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
          const dvec3 on = force[static_cast<std::size_t>(row * columns + column)];
          if (column == columns - 1) last += on;
          // Within, and on the edges along the pull, everything is in balance.
          if (column > 0 && column < columns - 1) CHECK(glm::length(on) < 1e-10 * modulus);
        }
      CHECK(glm::length(last) / height ==
            Approx(modulus * along * std::abs(along * along - 1) / 2).epsilon(1e-9));
      // The edge pulls back along the thread.
      CHECK(std::abs(last.x * pull.y - last.z * pull.x) < 1e-9 * glm::length(last));
      CHECK((last.x < 0.0) == (along > 1.0));
    }
}

TEST_CASE("sheared along its grain or 30 degrees off it, a sheet has the stress of its turned stiffness") {
  for (const double grain : {0.0, 30.0, -30.0, 45.0, 90.0})
    for (const double slant : {0.05, -0.1}) {
      const reference::World world = world_of(cotton(grain));
      const dmat2 gradient(1.0, 0.0, slant, 1.0);  // x grows with z
      const dmat2 stress = Stiffness(grain).stress(gradient);
      // On the last row, whose outward normal is z: F S z a metre.
      const dvec2 expected = gradient * (stress * dvec2(0.0, 1.0));
      if (grain == 0.0) CHECK(stress[0][1] == Approx(shear * slant).epsilon(1e-9));
      const auto force = forces(world, deformed(world, gradient));
      const double spacing = width / (columns - 1);
      INFO("grain " << grain << ", slant " << slant);
      for (int column = 1; column < columns - 1; ++column) {
        const dvec3 on = force[static_cast<std::size_t>((rows - 1) * columns + column)];
        CHECK(on.x == Approx(-expected.x * spacing).epsilon(1e-9));
        CHECK(on.z == Approx(-expected.y * spacing).epsilon(1e-9));
        for (int row = 1; row < rows - 1; ++row)
          CHECK(glm::length(force[static_cast<std::size_t>(row * columns + column)]) < 1e-9 * shear);
      }
    }
}

TEST_CASE("a sheet bent to a cylinder at any angle to its grain has the energy of its bending there") {
  for (const double grain : {0.0, 30.0, -70.0})
    for (const double direction : {0.0, 30.0, 90.0, 120.0}) {
      scene::Scene scene = cotton(grain, scene::Method::xpbd);  // which has the energy triangle by triangle
      scene.cloths[0].mesh = scene::Grid{13, 13, width, height};
      const reference::World world = world_of(scene);
      const double curvature = 3.0, a = direction * std::acos(-1.0) / 180,
                   off = (direction - grain) * std::acos(-1.0) / 180;
      std::vector<dvec3> place = world.model.rest_position;
      for (dvec3& x : place) {
        const double s = std::cos(a) * x.x + std::sin(a) * x.z;
        x.y = 0.5 * curvature * s * s;
      }
      const double c2 = std::cos(off) * std::cos(off), s2 = 1 - c2;
      const double bending = bend_warp * c2 * c2 + bend_weft * s2 * s2 + 4 * twist * c2 * s2;
      const double exact = 0.5 * (0.5 * width * height / 144) * bending * curvature * curvature;
      int inner = 0;
      for (const auto& element : world.model.elements.of<elements::Curvature>()) {
        // All of a row's vertices are the triangle's and its neighbours': two cells from the edge.
        bool far = true;
        dvec3 rows_of[3] = {};
        for (std::size_t k = 0; k < 12; ++k) {
          const dvec3& x = place[element.vertices[k]];
          for (std::size_t row = 0; row < 3; ++row) rows_of[row] += element.law.row[12 * row + k] * x;
          far = far && std::abs(x.x) < 0.35 * width && std::abs(x.z - height / 2) < 0.35 * height;
        }
        if (!far) continue;
        ++inner;
        double energy = 0.0;
        for (const dvec3& row : rows_of) energy += 0.5 * glm::dot(row, row);
        CHECK(energy == Approx(exact).epsilon(1e-7));
      }
      INFO("grain " << grain << ", bent along " << direction);
      CHECK(inner > 10);
    }
}

TEST_CASE("a flat sheet that turns rigidly feels no damping, stretched or not, whatever its grain") {
  const dvec3 spin(3.0, -5.0, 8.0);
  for (const double stretch : {1.0, 1.05}) {
    const reference::World world = world_of(cotton(25.0));
    const std::vector<dvec3> place = deformed(world, dmat2(stretch, 0.0, 0.0, 1.0));
    std::vector<dvec3> turning, stretching;
    for (const dvec3& x : place) {
      turning.push_back(glm::cross(spin, x));
      stretching.push_back({glm::length(spin) * x.x, 0.0, 0.0});
    }
    const auto still = forces(world, place), turned = reference::element_forces(world, place, turning),
               stretched = reference::element_forces(world, place, stretching);
    double felt = 0.0, scale = 0.0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      felt = std::max(felt, glm::distance(turned[i], still[i]));
      scale = std::max(scale, glm::distance(stretched[i], still[i]));
    }
    CHECK(scale > 0.1);  // a stretching of the same speed is damped [N]
    CHECK(felt < 1e-12 * scale);
  }
}
