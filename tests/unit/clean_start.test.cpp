// Scenes that start with crossings: refused where surfaces are to keep apart, with the pairs named.
#include "server/model/clean_start.h"

#include "tests/scenes.h"

using namespace clothlab;
using Kind = scene::ContactKind;

namespace {

/// A sheet of 3 x 3 vertices, and one standing on edge `height` above its middle row.
scene::Scene standing_on(double height) {
  scene::Scene scene = test::sheet(3, 3);
  scene.cloths[0].name = "lying";
  scene::Cloth& other = scene.cloths.emplace_back(scene.cloths[0]);
  other.name = "standing";
  other.transform = {{0.1, 1.0 + height + 0.5, 0.4}, {90.0, 0.0, 0.0}, 0.5};
  scene.self_collision = scene::SelfCollision{0.01, 0.2, Kind::surface};
  return scene;
}

std::string refusal(const scene::Scene& scene) {
  const Result<model::Model> made = model::build(scene);
  return made ? "" : made.error().text();
}

}  // namespace

TEST_CASE("a scene whose surfaces keep apart is refused if cloths start through each other, with the pairs") {
  scene::Scene scene = standing_on(-0.1);
  const Result<model::Model> made = model::build(scene);
  REQUIRE_FALSE(made);
  CHECK(made.error().where == "/self_collision/kind");
  INFO(made.error().text());
  CHECK(made.error().what.find("crossings: edge ") != std::string::npos);
  CHECK(made.error().what.find("of /cloths/0 (\"lying\")") != std::string::npos);
  CHECK(made.error().what.find("of /cloths/1 (\"standing\")") != std::string::npos);
  CHECK(made.error().remedy.find("\"points\"") != std::string::npos);
  scene.self_collision->kind = Kind::points;
  CHECK(refusal(scene).empty());
  scene.self_collision.reset();
  CHECK(refusal(scene).empty());
}

TEST_CASE("touching is a crossing at the start, a gap of a float's last digit is none") {
  scene::Scene scene = standing_on(0.0);
  CHECK_FALSE(refusal(scene).empty());
  scene.cloths[1].transform.translate.y += 0x1p-22;  // floats near 1 are 2^-23 apart
  CHECK(refusal(scene).empty());
  // The GPU gets positions as floats: in these, a smaller gap is none.
  scene.cloths[1].transform.translate.y = 1.5 + 0x1p-30;
  CHECK_FALSE(refusal(scene).empty());
}

TEST_CASE("a cloth that starts crumpled through itself is refused, one that starts stretched is not") {
  scene::Scene scene = test::sheet(20, 20);
  scene.self_collision = scene::SelfCollision{0.01, 0.2, Kind::surface};
  scene.cloths[0].start = scene::Stretch{{1.2, 1.0, 0.7}};
  CHECK(refusal(scene).empty());
  scene.cloths[0].start = scene::Scatter{0.5, 3};
  CHECK(refusal(scene).find("10000 or more crossings") != std::string::npos);
  scene.cloths[0].start = scene::Stretch{{0.0, 0.0, 0.0}};
  CHECK_FALSE(refusal(scene).empty());
}

TEST_CASE(
    "crossings are named in the numbers of a mesh's file, whose unused and equal vertices have become one") {
  scene::Scene scene = standing_on(-0.1);
  scene::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.vertex_of = {mesh::no_vertex, 0, 0, 1, mesh::no_vertex, 2};
  scene.cloths[1].mesh = mesh;
  scene.cloths[1].transform = {{0.1, 0.9, 0.4}, {-90.0, 0.0, 0.0}, 0.5};
  const std::string text = refusal(scene);
  INFO(text);
  CHECK(text.find("triangle 1-3-5 of /cloths/1") != std::string::npos);
}

TEST_CASE(
    "every preset with self-collision starts without crossings, so that its surfaces can be kept apart") {
  for (const std::string& name : scene::preset_names()) {
    INFO(name);
    scene::Scene scene = scene::load_preset(name)->scene;
    if (!scene.self_collision) continue;
    scene.self_collision->kind = Kind::surface;
    CHECK(refusal(scene) == "");
  }
}
