// Starts that are led out of bodies and of cloth ("start": {"dress": seconds}).
#include "server/model/dress.h"

#include <glm/geometric.hpp>

#include "server/model/bodies.h"
#include "server/model/clean_start.h"
#include "tests/body_meshes.h"
#include "tests/scenes.h"
#include "tests/solids.h"

using namespace clothlab;
using namespace clothlab::test;
using Kind = scene::ContactKind;

namespace {

constexpr double thickness = 0.004;

/// A tube about the x axis of `around` x 9 vertices, open at both ends.
scene::TriangleMesh tube(double radius, std::uint32_t around = 24) {
  scene::TriangleMesh mesh;
  constexpr std::uint32_t rings = 9;
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t i = 0; i < around; ++i) {
      const double angle = 2.0 * M_PI * (i + 0.5 * (ring % 2)) / around;
      mesh.vertices.emplace_back(0.05 * ring - 0.2, radius * std::cos(angle), radius * std::sin(angle));
    }
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t a = ring * around + i, b = ring * around + (i + 1) % around;
      mesh.triangles.push_back({a, b, b + around});
      mesh.triangles.push_back({b + around, a + around, a});
    }
  return mesh;
}

scene::Cloth garment(scene::TriangleMesh mesh, double seconds) {
  scene::Cloth cloth = sheet(2, 2).cloths[0];
  cloth.name = "garment";
  cloth.mesh = std::move(mesh);
  cloth.pins.clear();
  cloth.start = scene::Dress{seconds};
  return cloth;
}

scene::Scene dressed(scene::Cloth cloth, std::vector<scene::Collider> bodies = {}) {
  scene::Scene scene = sheet(2, 2);
  scene.cloths = {std::move(cloth)};
  scene.colliders = std::move(bodies);
  scene.self_collision = scene::SelfCollision{thickness, 0.2, Kind::surface};
  return scene;
}

scene::Scene as_it_is(scene::Scene scene) {
  for (scene::Cloth& cloth : scene.cloths) cloth.start = std::monostate{};
  return scene;
}

/// A ball of 0.2 m about the middle of a tube that is moved down by `down` [m].
scene::Scene tube_through_ball(double down, bool open = false) {
  scene::Cloth cloth = garment(tube(0.21), 0.5);
  cloth.transform.translate = {0.0, -down, 0.0};
  scene::TriangleMesh ball = ball_mesh(3);
  if (open) ball = lower_half(std::move(ball));
  return dressed(std::move(cloth), {body_of(std::move(ball), {dvec3(0.0), dvec3(0.0), 0.2})});
}

}  // namespace

TEST_CASE(
    "a tube that goes through a ball starts around it once it is led out, by a little more than it was in") {
  const scene::Scene scene = tube_through_ball(0.03);
  REQUIRE_FALSE(model::build(as_it_is(scene)));
  const Result<model::Model> model = model::build(scene);
  INFO((model ? "" : model.error().text()));
  REQUIRE(model);
  REQUIRE(model->dressed);
  CHECK(model->dressed->done);
  // The top is 0.02 m deep; contact keeps `thickness` free, and what lies between vertices goes out as well.
  CHECK(model->dressed->farthest > 0.02);
  CHECK(model->dressed->farthest < 0.05);
  CHECK(model->dressed->vertices > 20);
  CHECK_FALSE(model::dressed_note(*model).empty());
  double high = -1.0, low = 1.0;
  for (const dvec3& x : model->start_position) {
    high = std::max(high, x.y);
    low = std::min(low, x.y);
  }
  CHECK(high > 0.2);  // on its own side, not below with the rest
  CHECK(low < -0.2);
}

TEST_CASE("cloth keeps its lengths as it is led out, to a few percent where the body leaves room") {
  const Result<model::Model> model = model::build(tube_through_ball(0.02));
  REQUIRE(model);
  double most = 0.0;
  for (const auto& [a, b, c] : model->triangles)
    for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
      most = std::max(most, glm::distance(model->start_position[p], model->start_position[q]) /
                                glm::distance(model->rest_position[p], model->rest_position[q]));
  CHECK(most < 1.1);
}

TEST_CASE("the same scene is led out to the same places, and what crosses nothing stays") {
  const scene::Scene scene = tube_through_ball(0.03);
  const Result<model::Model> once = model::build(scene), again = model::build(scene);
  REQUIRE(once);
  REQUIRE(again);
  CHECK(once->start_position == again->start_position);
  scene::Scene apart = dressed(garment(tube(0.25), 0.5));
  const Result<model::Model> still = model::build(apart);
  REQUIRE(still);
  CHECK(still->dressed->vertices == 0);
  CHECK(still->start_position == still->rest_position);
}

TEST_CASE("an open body is left to the side on which most of the cloth is") {
  const scene::Scene scene = tube_through_ball(-0.03, true);
  REQUIRE_FALSE(model::build(as_it_is(scene)));
  const Result<model::Model> model = model::build(scene);
  INFO((model ? "" : model.error().text()));
  CHECK(model);
}

TEST_CASE("a solid is left, too, and pinned vertices stay") {
  scene::Cloth cloth = garment(tube(0.21), 0.5);
  cloth.transform.translate = {0.0, 0.0, 0.05};
  cloth.pins = {scene::Pin{scene::AtVertex{0}, scene::Motion{}, true}};
  const scene::Collider ball{"ball", scene::Sphere{dvec3(0.0), 0.2}, 0.3, 0.0, {}};
  scene::Scene scene = dressed(cloth, {ball});
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  CHECK(model->start_position[0] == model->rest_position[0]);
  for (std::size_t i = 1; i < model->start_position.size(); ++i)
    CHECK(glm::length(model->start_position[i]) > 0.2);
  std::get<scene::Dress>(scene.cloths[0].start).seconds = 0.002;  // a step
  const Result<model::Model> early = model::build(scene);
  REQUIRE(early);
  CHECK_THAT(model::dressed_note(*early), Catch::Contains("still in a solid"));
}

TEST_CASE("cloth deep in a body is led out, however large the thickness is") {
  scene::Cloth cloth = garment({}, 1.0);
  cloth.mesh = scene::Grid{5, 5, 0.1, 0.1};
  cloth.transform.translate = {0.0, 0.7, 0.0};  // 0.3 m below the surface, twelve edges
  scene::Scene scene = dressed(cloth, {body_of(ball_mesh(3))});
  REQUIRE_FALSE(model::build(as_it_is(scene)));
  for (const double thick : {thickness, 10.0}) {
    INFO(thick << " m");
    scene.self_collision->thickness = thick;
    const Result<model::Model> model = model::build(scene);
    REQUIRE(model);
    for (const dvec3& x : model->start_position) CHECK(glm::length(x) > 0.98);  // the ball's triangles
  }
}

TEST_CASE("cloth through cloth goes back to the side from which it came") {
  // A sheet whose edge is pushed down through another one.
  scene::Scene scene = sheet(9, 9);
  scene.cloths[0].pins.clear();
  scene.cloths[0].name = "lying";
  scene::Cloth& other = scene.cloths.emplace_back(scene.cloths[0]);
  other.name = "standing";
  other.transform = {{0.02, scene.cloths[0].transform.translate.y + 0.44, 0.5}, {90.0, 0.0, 0.0}, 0.5};
  scene.self_collision = scene::SelfCollision{thickness, 0.2, Kind::surface};
  REQUIRE_FALSE(model::build(scene));
  for (scene::Cloth& cloth : scene.cloths) cloth.start = scene::Dress{0.5};
  const Result<model::Model> model = model::build(scene);
  INFO((model ? "" : model.error().text()));
  REQUIRE(model);
  CHECK(model->dressed->farthest < 0.1);
}

TEST_CASE("what cannot be led out is refused with the places and what was tried") {
  scene::Cloth cloth = garment(tube(0.21), 0.01);
  for (std::uint32_t i = 0; i < 216; ++i) cloth.pins.push_back({scene::AtVertex{i}, scene::Motion{}, true});
  cloth.transform.translate = {0.0, 0.03, 0.0};
  const Result<model::Model> model =
      model::build(dressed(cloth, {body_of(ball_mesh(3), {dvec3(0.0), dvec3(0.0), 0.2})}));
  REQUIRE_FALSE(model);
  INFO(model.error().text());
  CHECK(model.error().where == "/colliders/0");
  CHECK(model.error().what.find("after 0.01 s of leading out") != std::string::npos);
  CHECK(model.error().facts.find("crossings") != std::string::npos);
}
