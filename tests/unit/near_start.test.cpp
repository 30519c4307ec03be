// The warning of a start so near that contact between surfaces has no room.
#include "server/model/near_start.h"

#include "tests/scenes.h"

using namespace clothlab;

namespace {

/// Two sheets, one above the other, `gap` [m] apart, both moved by `aside` [m] along x.
scene::Scene two_sheets(double gap, double aside = 0.0) {
  scene::Scene scene = test::sheet(9, 9);
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[0].name = "lower";
  scene.cloths[1].name = "upper";
  scene.cloths[0].transform.translate = {aside, 0.0, 0.0};
  scene.cloths[1].transform.translate = {aside, gap, 0.0};
  scene.self_collision = scene::SelfCollision{0.005, 0.2, scene::ContactKind::surface};
  return scene;
}

std::string warning(const scene::Scene& scene) {
  const Result<model::Model> model = model::build(scene);
  INFO((model ? "" : model.error().text()));
  REQUIRE(model);
  return model::near_start_warning(*model, scene);
}

}  // namespace

TEST_CASE(
    "a start that leaves contact no room is told with the pair, its gap, the one that is needed, and a "
    "remedy") {
  const std::string told = warning(two_sheets(1e-7));
  INFO(told);
  CHECK(told.find("of /cloths/0 (\"lower\")") != std::string::npos);
  CHECK(told.find("of /cloths/1 (\"upper\")") != std::string::npos);
  CHECK(told.find("1e-07 m") != std::string::npos);
  CHECK(told.find("move them apart") != std::string::npos);
  // The largest coordinate of 1 m costs 2.5e-7 m, an edge of 1/8 m 1e-6 of it, on both sides of the plane.
  CHECK(warning(two_sheets(1e-6)).empty());
  CHECK(warning(two_sheets(0.005)).empty());
  // Farther from the origin rounding is coarser.
  CHECK_FALSE(warning(two_sheets(2e-6, 10.0)).empty());
  CHECK(warning(two_sheets(2e-5, 10.0)).empty());
}

TEST_CASE("only what contact between surfaces keeps apart is too near") {
  scene::Scene points = two_sheets(1e-7);
  points.self_collision->kind = scene::ContactKind::points;
  CHECK(warning(points).empty());
  points.self_collision.reset();
  CHECK(warning(points).empty());
  CHECK(warning(test::seed()).empty());
  scene::Scene one = two_sheets(0.1);
  one.cloths.pop_back();
  CHECK(warning(one).empty());  // its own triangles share vertices, or are cells apart
}
