// A disc of cloth over a pedestal, as drape is measured (Cusick 1968): held between two plates of 0.18 m, it
// hangs over by 0.06 m all around. The drape coefficient is the share of the free ring that its shadow
// covers.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "server/reference/rest_shape.h"
#include "tests/catch.h"
#include "tests/physics/stage.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using glm::dvec3;

namespace {

constexpr double pedestal = 0.09, edge = 0.15;  // radii [m]
constexpr int rings = 10, held_rings = 6;
const double pi = std::acos(-1.0);

std::uint32_t first_of(int ring) {
  return ring == 0 ? 0 : static_cast<std::uint32_t>(1 + 3 * ring * (ring - 1));
}

/// Rings of 6, 12, 18, ... vertices around one, all triangles nearly alike.
scene::Scene disc(const scene::Fem& material, double area_density) {
  scene::Scene scene = test::bare_scene(scene::Method::implicit_euler, 1e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene::TriangleMesh mesh;
  mesh.vertices.push_back({0.0, 0.0, 0.0});
  for (int ring = 1; ring <= rings; ++ring)
    for (int n = 0; n < 6 * ring; ++n) {
      const double a = pi / 3 * n / ring, r = edge * ring / rings;
      mesh.vertices.push_back({r * std::cos(a), 0.0, -r * std::sin(a)});
    }
  for (int ring = 1; ring <= rings; ++ring)
    for (int side = 0; side < 6; ++side)
      for (int n = 0; n < ring; ++n) {
        const auto outer = [&](int k) {
          return first_of(ring) + static_cast<std::uint32_t>((side * ring + k) % (6 * ring));
        };
        const auto inner = [&](int k) {
          return ring == 1 ? 0
                           : first_of(ring - 1) +
                                 static_cast<std::uint32_t>((side * (ring - 1) + k) % (6 * (ring - 1)));
        };
        mesh.triangles.push_back({inner(n), outer(n), outer(n + 1)});
        if (n + 1 < ring) mesh.triangles.push_back({inner(n), outer(n + 1), inner(n + 1)});
      }
  scene::Cloth cloth;
  cloth.mesh = mesh;
  cloth.mass = {scene::Mass::Kind::area_density, area_density};
  cloth.material = material;
  for (std::uint32_t i = 0; i < first_of(held_rings + 1); ++i) cloth.pins.push_back({scene::AtVertex{i}, {}});
  scene.cloths = {cloth};
  return scene;
}

struct Drape {
  double coefficient = 0;     ///< of the shadow
  double lowest = 0;          ///< [m]
  double furthest_in = edge;  ///< the least distance of what hangs from the axis [m]
  double longest = 0;         ///< the largest strain
};

Drape draped(const scene::Scene& scene) {
  reference::World world = world_of(scene);
  std::vector<dvec3> shape = world.model.rest_position;
  // A hint of folds: which ones grow is the cloth's affair.
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const double r = glm::length(shape[i]), a = std::atan2(shape[i].z, shape[i].x);
    if (r > pedestal + 1e-9)
      shape[i].y = (r - pedestal) * (0.02 * std::cos(5 * a) + 0.02 * std::sin(7 * a + 1) - 0.1);
  }
  for (const double share : {0.05, 0.2, 0.5, 1.0}) {
    world.scene.gravity = share * scene.gravity;
    const auto found = reference::rest_shape(world, shape, {});
    INFO((found ? "" : found.error().text()));
    REQUIRE(found);
    shape = found->position;
  }
  Drape drape;
  double shadow = 0.0;
  for (int n = 0; n < 6 * rings; ++n) {
    const dvec3 &a = shape[first_of(rings) + static_cast<std::size_t>(n)],
                &b = shape[first_of(rings) + static_cast<std::size_t>((n + 1) % (6 * rings))];
    shadow += 0.5 * (a.z * b.x - a.x * b.z);
  }
  drape.coefficient = (shadow - pi * pedestal * pedestal) / (pi * (edge * edge - pedestal * pedestal));
  for (std::size_t i = first_of(held_rings + 1); i < shape.size(); ++i) {
    drape.lowest = std::min(drape.lowest, shape[i].y);
    drape.furthest_in = std::min(drape.furthest_in, std::hypot(shape[i].x, shape[i].z));
  }
  for (const auto& element : world.model.elements.of<elements::Membrane>())
    drape.longest = std::max(drape.longest,
                             elements::element_strain(element.law, edges(element, 0, std::as_const(shape))));
  return drape;
}

scene::Fem cloth_of(double warp, double weft, double poisson, double shear, double bend_warp,
                    double bend_weft) {
  return {warp, weft, poisson, shear, {bend_warp, bend_weft, std::nullopt}, 0.0, 0.0, std::nullopt};
}

}  // namespace

TEST_CASE("a disc drapes the more over a pedestal the less it resists bending, silk more than denim") {
  // Clyde et al. 2017: a square metre weighs 83 and 400 g.
  const Drape silk = draped(disc(cloth_of(326, 755, 0.5, 51, 2e-6, 5e-6), 0.083)),
              denim = draped(disc(cloth_of(1673, 3151, 0.5, 808, 115e-6, 216e-6), 0.4)),
              worn = draped(disc(cloth_of(1673, 3151, 0.5, 808, 23e-6, 43e-6), 0.4));
  for (const auto& [name, drape] :
       {std::pair("silk", silk), {"denim", denim}, {"denim a fifth as stiff to bend", worn}}) {
    INFO(name << ": " << drape.coefficient << ", hangs to " << drape.lowest << " m, in to "
              << drape.furthest_in << " m, strain " << drape.longest);
    CHECK(drape.coefficient > 0.1);
    CHECK(drape.coefficient < 0.98);
    CHECK(drape.lowest > -1.01 * (edge - pedestal));
    CHECK(drape.longest < 0.02);
    // Nothing is drawn in under the pedestal's top but the hem of a fold, by what silk folds to under its own
    // weight, (B / weight)^(1/3) = 16 mm.
    CHECK(drape.furthest_in > pedestal - 0.016);
  }
  CHECK(silk.coefficient < 0.8 * denim.coefficient);
  CHECK(worn.coefficient < 0.9 * denim.coefficient);
}
