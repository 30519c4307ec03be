// The reference's rest shape against statics, and its errors if there is none.
#include "server/reference/rest_shape.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using scene::Method;

namespace {

std::vector<glm::dvec3> shape_of(const scene::Scene& scene) {
  const Result<reference::RestShape> found = reference::rest_shape(world_of(scene));
  INFO((found ? "" : found.error().text()));
  REQUIRE(found);
  return found->position;
}

/// A narrow band of `links` quads, `length` [m] long, held at both ends, which are `span` [m] apart; it
/// starts as a V. As it folds about z its edges and diagonals keep their lengths, so that it hangs like a
/// chain.
scene::Scene hanging_band(int links, double length, double span, double k) {
  scene::Scene scene = test::bare_scene(Method::implicit_euler, 1e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene::TriangleMesh mesh;
  const double depth = std::sqrt(length * length - span * span) / 2;
  for (int n = 0; n <= links; ++n) {
    const double along = static_cast<double>(n) / links, y = -depth * (1 - std::abs(2 * along - 1));
    for (const double z : {0.0, 0.1}) mesh.vertices.push_back({span * along, y, z});
    if (n == links) break;
    const auto first = static_cast<std::uint32_t>(2 * n);
    mesh.triangles.push_back({first, first + 1, first + 3});
    mesh.triangles.push_back({first, first + 3, first + 2});
  }
  scene::Cloth cloth;
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::per_vertex, 0.5 / links};
  cloth.material = scene::Springs{k, 0.0, 0.0, 0.0};
  const auto last = static_cast<std::uint32_t>(2 * links);
  for (const std::uint32_t vertex : {0u, 1u, last, last + 1})
    cloth.pins.push_back({scene::AtVertex{vertex}, {}});
  scene.cloths = {cloth};
  return scene;
}

scene::Scene small_cloth() {
  scene::Scene scene = test::swinging_cloth(Method::implicit_euler, 1e-3);
  std::get<scene::Grid>(scene.cloths[0].mesh) = {9, 9, 0.5, 0.5};
  scene.cloths[0].pins[1].at = scene::AtCorner{8, 0};
  return scene;
}

double lowest(const std::vector<glm::dvec3>& shape) {
  double y = 0.0;
  for (const glm::dvec3& x : shape) y = std::min(y, x.y);
  return y;
}

}  // namespace

TEST_CASE(
    "a hanging chain of N masses is longer by M g L / (2 Y) (1 + 1/N), and each node where its load puts "
    "it") {
  for (const int links : {1, 2, 7, 40}) {
    const double m = 0.3 / links, k = 50.0 * links, g = 9.81;  // M = 0.3 kg, Y = 50 N, L = 1 m
    scene::Scene scene = test::chain(Method::implicit_euler, 1e-3, links, k, m);
    scene.gravity = {0.0, 0.0, g};
    const std::vector<glm::dvec3> shape = shape_of(scene);
    // The solver leaves at most 1e-12 of k times the lengths at a node (a rung of 1 m, two links) unbalanced;
    // every link above carries that, too.
    const double bound = 1e-12 * (1.0 + 2.0 / links) * links * links;
    double z = 0.0;
    for (int n = 1; n <= links; ++n) {
      z += 1.0 / links + (links - n + 1) * m * g / k;
      CHECK(std::abs(shape[static_cast<std::size_t>(2 * n)].z - z) < bound);
    }
    CHECK(z - 1.0 == Approx(0.3 * g / (2 * 50.0) * (1.0 + 1.0 / links)));
  }
}

TEST_CASE("a stiff chain held at both ends hangs in the catenary") {
  struct {
    double length, sag;
  } const cases[] = {{1.05, .1393}, {1.1, .2003}, {1.2, .2923}, {1.5, .5026}, {2.0, .7964}};
  for (const auto& [length, sag] : cases) {
    const double coarse = -lowest(shape_of(hanging_band(16, length, 1.0, 1e6)));
    const double fine = -lowest(shape_of(hanging_band(32, length, 1.0, 1e6)));
    const double limit = (4 * fine - coarse) / 3;  // a polygon's sag is off by 1/N^2; the next term by 1/N^4
    INFO("length " << length << ": sag " << coarse << ", " << fine << ", extrapolated " << limit);
    // Half a digit of the table; the stretch of at most 10 N / (k l) = 3e-4, which changes the sag by as much
    // or twice.
    CHECK(std::abs(limit - sag) < 5e-5 + 6e-4);
    CHECK(std::abs(limit - sag) < 0.3 * std::abs(coarse - sag) + 2e-4);
  }
}

TEST_CASE("where a cloth hangs still, its pins carry its weight and no step moves it") {
  scene::Scene scene = test::swinging_cloth(Method::implicit_euler, 1e-4);
  const reference::World world = world_of(scene);
  const std::vector<glm::dvec3> shape = shape_of(scene);
  const std::vector<glm::dvec3> still(shape.size(), glm::dvec3(0.0));
  const std::vector<glm::dvec3> force = reference::element_forces(world, shape, still);
  glm::dvec3 on_pins(0.0);
  for (std::size_t i = 0; i < shape.size(); ++i)
    if (world.pinned(i)) on_pins += force[i];
  const double weight = 9.81 * 1.4648e-4 * (289 - 2);
  CHECK(glm::distance(on_pins, glm::dvec3(0.0, -weight, 0.0)) < 1e-8 * weight);

  reference::State state{shape, still, std::vector<int>(shape.size(), 0)};
  for (int n = 0; n < 10; ++n) reference::step(world, state);
  for (std::size_t i = 0; i < shape.size(); ++i) CHECK(glm::distance(state.position[i], shape[i]) < 1e-9);
}

TEST_CASE("a rest shape that cannot be is an error that says why") {
  const auto error_of = [](const scene::Scene& scene) {
    const auto found = reference::rest_shape(world_of(scene));
    REQUIRE_FALSE(found);
    return found.error();
  };
  const scene::Scene cloth = small_cloth();
  scene::Scene scene = cloth;
  scene.cloths[0].springs().strain_limit = 0.001;
  CHECK(error_of(scene).where == "/cloths/0/material/strain_limit");

  scene = cloth;
  scene.colliders = {{"floor", scene::Plane{{0.0, -0.2, 0.0}, {0.0, 1.0, 0.0}}, 0.0, 0.0, {}}};
  CHECK(error_of(scene).where == "/colliders");
  scene.colliders[0].shape = scene::Plane{{0.0, -2.0, 0.0}, {0.0, 1.0, 0.0}};  // out of reach: allowed
  CHECK(reference::rest_shape(world_of(scene)));

  scene.cloths[0].pins.clear();
  CHECK(error_of(scene).where == "/cloths/0/pins");
}
