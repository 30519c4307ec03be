// Solids that a mesh is too coarse for are told, with what holds; those that hold are not.
#include "server/sim/slipping.h"

#include <cmath>

#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

/// A sheet of 1 m, `side` vertices a side, with a collider.
scene::Scene sheet_with(int side, const scene::Shape& shape,
                        scene::ContactKind kind = scene::ContactKind::points) {
  scene::Scene scene;
  scene.cloths.emplace_back().mesh = scene::Grid{side, side, 1.0, 1.0};
  scene.colliders = {{"solid", shape, 0.3, 0.0, {}}};
  scene.self_collision = scene::SelfCollision{0.002, 0.3, kind};
  return scene;
}

std::string warning(const scene::Scene& scene) {
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  return sim::slipping_warning(scene, *model);
}

}  // namespace

TEST_CASE(
    "a sphere or capsule that fits between the vertices of a triangle is told, with the radius that holds") {
  // Right triangles with sides of 1 / 16 m: no point is farther from a corner than half of the diagonal.
  const double covering = std::sqrt(0.5) / 16.0, holds = covering - 0.001;  // less half of the thickness
  const auto sphere = [](double radius) { return scene::Sphere{{0.0, -1.0, 0.5}, radius}; };
  const auto capsule = [](double radius) { return scene::Capsule{{0, -1, 0}, {0, -1, 1}, radius}; };
  for (const auto kind : {scene::ContactKind::points, scene::ContactKind::surface}) {
    CHECK(warning(sheet_with(17, sphere(1.001 * holds), kind)).empty());
    CHECK(warning(sheet_with(17, capsule(1.001 * holds), kind)).empty());
    CHECK(warning(sheet_with(17, sphere(0.999 * holds), kind)).find("/colliders/0") == 0);
    const std::string told = warning(sheet_with(17, capsule(0.0012), kind));
    CHECK(told.find("a radius of 0.0432 m, a mesh 20 times as fine") != std::string::npos);
  }
}

TEST_CASE(
    "a box whose edges may go deep into triangles is told, but not where its edges are kept apart from "
    "them") {
  const scene::Box box{{0.0, -1.0, 0.5}, {0.2, 0.2, 0.2}};
  const std::string told = warning(sheet_with(9, box));
  CHECK(told.find("may go 0.061 m into the triangles of /cloths/0") !=
        std::string::npos);  // sqrt(2) / 8 / sqrt(8)
  CHECK(told.find("\"surface\"") != std::string::npos);
  CHECK(warning(sheet_with(9, box, scene::ContactKind::surface)).empty());
  CHECK(warning(sheet_with(41, box)).empty());
}

TEST_CASE("no preset has a solid that its meshes are too coarse for") {
  for (const std::string& name : scene::preset_names()) {
    INFO(name);
    CHECK(warning(scene::load_preset(name)->scene) == "");
  }
}
