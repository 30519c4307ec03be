// Bodies of triangles: read, placed and moved, told apart inside and outside, refused where cloth starts in
// or through them.
#include "server/model/bodies.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <random>

#include "server/model/clean_start.h"
#include "server/model/crossings.h"
#include "server/model/mesh_file.h"
#include "server/model/motion.h"
#include "server/model/numbering.h"
#include "server/scene/ranges.h"
#include "server/scene/solid.h"
#include "server/sim/colliders.h"
#include "server/sim/plan.h"
#include "tests/body_meshes.h"
#include "tests/scenes.h"
#include "tests/unit/base_document.h"

using namespace clothlab;
using glm::dvec3;
using scene::json;
using test::ball_mesh;
using test::body_of;
using test::cube_mesh;

namespace {

json json_of(const scene::TriangleMesh& mesh) {
  json vertices = json::array(), triangles = json::array();
  for (const dvec3& v : mesh.vertices) vertices.push_back({v.x, v.y, v.z});
  for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, b, c});
  return {{"vertices", vertices}, {"triangles", triangles}};
}

Result<scene::Document> with_collider(const json& collider) {
  json value = test::base_document();
  value["colliders"] = json::array({collider});
  return scene::validate(value);
}

/// The error for a mesh of these vertices and triangles, as a body that is not mended; empty: none.
std::string refusal(const char* vertices, const char* triangles) {
  const auto document = with_collider(
      {{"mesh",
        {{"vertices", json::parse(vertices)}, {"triangles", json::parse(triangles)}, {"mend", false}}}});
  return document ? "" : document.error().text();
}

/// A sheet above a body of this mesh.
scene::Scene over(const scene::TriangleMesh& mesh, const scene::Transform& transform = {}) {
  scene::Scene scene = test::sheet(5, 5);
  scene.cloths[0].name = "scarf";
  scene.colliders = {{"floor", scene::Plane{}, 0, 0, {}}, body_of(mesh, transform)};
  return scene;
}

std::string refusal(const scene::Scene& scene) {
  const Result<model::Model> made = model::build(scene);
  return made ? "" : made.error().text();
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Whether a body of this mesh contains the point.
bool inside(const scene::TriangleMesh& mesh, const dvec3& point) {
  model::Model model;
  scene::Scene scene;
  scene.colliders = {body_of(mesh)};
  model::add_bodies(model, scene);
  return model::BodyInside(model, 0, model::body_positions(model, 0.0)).contains(point);
}

}  // namespace

TEST_CASE("a body's mesh and transform are read, with defaults and without what no face uses") {
  json collider = {{"mesh", json_of(cube_mesh())}, {"friction", 0.5}};
  collider["mesh"]["mend"] = true;
  collider["mesh"]["vertices"].insert(collider["mesh"]["vertices"].begin(), json::array({9, 9, 9}));
  for (json& triangle : collider["mesh"]["triangles"])
    for (json& corner : triangle) corner = corner.get<int>() + 1;
  const auto document = with_collider(collider);
  REQUIRE(document);
  const auto& body = std::get<scene::Body>(document->scene.colliders[0].shape);
  CHECK(body.mesh->vertices == cube_mesh().vertices);
  CHECK(body.mesh->triangles == cube_mesh().triangles);
  CHECK(body.mesh->vertex_of.size() == 9);
  CHECK(body.transform == scene::Transform{});
  CHECK(document->scene.colliders[0].friction == 0.5);
  const json& written = document->value["colliders"][0];
  CHECK(written["transform"] == json{{"translate", {0, 0, 0}}, {"rotate", {0, 0, 0}}, {"scale", 1.0}});
  CHECK(written["mesh"] == collider["mesh"]);
  const auto again = scene::validate(document->value);
  REQUIRE(again);
  CHECK(*again == *document);
}

TEST_CASE("a file's mesh may be a body, which has its triangles alone") {
  const auto document = with_collider({{"mesh", {{"obj", "presets/torso.obj"}}}});
  REQUIRE(document);
  const auto& mesh = *std::get<scene::Body>(document->scene.colliders[0].shape).mesh;
  CHECK(mesh.vertices.size() == 36 * 40 + 2);
  CHECK(mesh.triangles.size() == 2 * 36 * 40);
  CHECK(inside(mesh, {0.0, 1.2, 0.0}));
  CHECK_FALSE(inside(mesh, {0.0, 1.2, 0.2}));
}

TEST_CASE("what is no body is refused with its place, what was found and what is allowed") {
  const char* const flat = "[[0,0,0],[1,0,0],[2,0,0],[0,1,0]]";
  CHECK(has(refusal(flat, "[[0,1,3],[0,1,2]]"), "/colliders/0/mesh: triangle 1: "));
  CHECK(has(refusal(flat, "[[0,1,3],[0,1,4]]"), "/colliders/0/mesh/triangles/1/2: "));
  CHECK(has(refusal(flat, "[[0,1,3],[3,0,1]]"),
            "triangle 1: a triangle at the same place as that of triangle 0"));
  CHECK(has(refusal("[[0,0,0],[1,0,0],[1,0,0],[0,1,0]]", "[[0,1,3],[1,2,3]]"),
            "two corners at the same place"));
  CHECK(has(refusal(flat, "[]"), "/colliders/0/mesh/triangles: "));
  const auto refused = [](const json& collider) {
    const auto document = with_collider(collider);
    return document ? "" : document.error().text();
  };
  const json cube = json_of(cube_mesh());
  const json point = {{"center", {0, 0, 0}}, {"radius", 1}};
  CHECK(has(refused({{"mesh", {{"grid", json::object()}}}}), "/colliders/0/mesh/grid: "));
  CHECK(has(refused({{"mesh", {{"obj", "presets/torso.obj"}, {"pattern", nullptr}}}}), "/mesh/pattern: "));
  CHECK(has(refused({{"mesh", {{"obj", "presets/torso.obj"}, {"vertices", cube["vertices"]}}}}), "either"));
  CHECK(has(refused({{"mesh", {{"obj", "../torso.obj"}}}}), "/colliders/0/mesh/obj: "));
  CHECK(has(refused({{"mesh", cube}, {"sphere", point}}), "exactly one of"));
  CHECK(has(refused({{"sphere", point}, {"transform", json::object()}}), "only beside \"mesh\""));
  CHECK(has(refused({{"mesh", cube}, {"transform", {{"scale", 0}}}}), "/colliders/0/transform/scale: "));
}

TEST_CASE("all bodies together have at most 200000 triangles and as many vertices") {
  const auto half = with_collider({{"mesh", json_of(ball_mesh(6))}});  // 81920 triangles
  REQUIRE(half);
  json value = half->value;
  value["colliders"].push_back(value["colliders"][0]);
  value["colliders"][1]["name"] = "second";
  CHECK(scene::validate(value));
  value["colliders"].push_back(value["colliders"][0]);
  value["colliders"][2]["name"] = "third";
  const auto third = scene::validate(value);
  REQUIRE_FALSE(third);
  CHECK(third.error().where == "/colliders/2/mesh");
  CHECK(has(third.error().what, "245760 triangles"));
}

TEST_CASE("a body is where its transform and then its motion put it, in the model, on the page and drawn") {
  const scene::Transform transform{{0.3, 2.5, -0.2}, {20.0, -70.0, 130.0}, 0.4};
  const scene::TriangleMesh mesh = ball_mesh(0);
  const dvec3 axis = glm::normalize(dvec3(1, 2, -1));
  for (const scene::Motion& motion : {scene::Motion{}, scene::Motion{scene::Oscillate{axis, 0.3, 0.7}},
                                      scene::Motion{scene::Linear{{0.1, 0, 0.4}}},
                                      scene::Motion{scene::Spin{axis, {0.2, 0.1, 0}, 100.0}}}) {
    scene::Scene scene = test::sheet(3, 3);
    scene.colliders = {body_of(cube_mesh(), {{5, 5, 5}, {}, 1}), body_of(mesh, transform, motion, "other")};
    const Result<model::Model> model = model::build(scene);
    REQUIRE(model);
    REQUIRE(model->bodies.size() == 2);
    const model::BodyRange& body = model->bodies[1];
    CHECK(body.collider == 1);
    CHECK((body.first_vertex == 8 && body.vertex_count == 12));
    CHECK((body.first_triangle == 12 && body.triangle_count == 20));
    CHECK(std::count(model->vertex_body.begin(), model->vertex_body.end(), 1u) == 12);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        CHECK(model->body_triangles[12 + i][k] == mesh.triangles[i][k] + 8 + model->vertex_count());
    for (const double time : {0.0, 0.37, 5.0}) {
      const std::vector<dvec3> now = model::body_positions(*model, time);
      const scene::Collider seen = sim::colliders_at(scene, time)[1];
      const auto& moved = std::get<scene::Body>(seen.shape);
      CHECK(moved.mesh == std::get<scene::Body>(scene.colliders[1].shape).mesh);
      for (std::size_t i = 0; i < 12; ++i) {
        // About x, then y, then z, then by the motion.
        dvec3 place = 0.4 * mesh.vertices[i];
        for (int about = 0; about < 3; ++about) {
          const int a = (about + 1) % 3, b = (about + 2) % 3;
          const double angle = glm::radians(transform.rotate[about]), c = std::cos(angle),
                       s = std::sin(angle);
          dvec3 turned = place;
          turned[a] = c * place[a] - s * place[b];
          turned[b] = s * place[a] + c * place[b];
          place = turned;
        }
        place = model::pose(motion, time).place(place + transform.translate);
        CHECK(glm::distance(now[8 + i], place) < 1e-12);
        // As the page and the renderer place it: by the transform that is told.
        const json told = scene::shape_to_json(moved)["transform"];
        const scene::Transform by{moved.transform};
        CHECK(told["rotate"][1] == by.rotate.y);
        scene::Scene there = scene;
        there.colliders[1].shape = scene::Body{moved.mesh, by};
        there.colliders[1].motion = {};
        model::Model drawn;
        model::add_bodies(drawn, there);
        CHECK(glm::distance(drawn.body_position[8 + i], place) < 1e-12);
      }
    }
  }
}

TEST_CASE("a body keeps its place in a model whose cloth is renumbered") {
  scene::Scene scene = test::sheet(4, 4);
  scene.colliders = {body_of(cube_mesh(), {{0, 3, 0}, {}, 1})};
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  std::vector<std::uint32_t> places(16);
  for (std::uint32_t i = 0; i < 16; ++i) places[i] = 15 - i;
  const model::Model turned = model::renumbered(*model, places);
  CHECK(turned.body_triangles == model->body_triangles);
  CHECK(turned.body_position == model->body_position);
}

TEST_CASE("points are inside a closed body or not, also level with its corners, and inside out too") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> either(-1.5, 1.5);
  for (const scene::TriangleMesh& cube : {cube_mesh(), test::turned_over(cube_mesh())})
    for (int i = 0; i < 2000; ++i) {
      dvec3 point(either(random), either(random), either(random));
      // Many rays go through corners, edges and diagonals.
      if (i % 2 == 1) point = glm::round(4.0 * point) / 4.0;
      const dvec3 far = glm::abs(point);
      const double most = std::max({far.x, far.y, far.z});
      if (most == 1.0) continue;  // on the surface
      INFO(point.x << " " << point.y << " " << point.z);
      CHECK(inside(cube, point) == (most < 1.0));
    }
  const scene::TriangleMesh ball = ball_mesh(2);
  for (int i = 0; i < 500; ++i) {
    const dvec3 point(either(random), either(random), either(random));
    const double from = glm::length(point);
    if (from > 0.9 && from < 1.0) continue;  // between a ball and its triangles
    CHECK(inside(ball, point) == (from <= 0.9));
  }
}

TEST_CASE(
    "parts that overlap are one body, one turned over inside another is a hollow, open ones have no inside") {
  const scene::TriangleMesh cube = cube_mesh();
  const scene::TriangleMesh two = test::together(cube, cube, 1.0, {1.0, 0.25, 0.25});
  CHECK(inside(two, {0.5, 0.5, 0.5}));
  CHECK(inside(two, {1.5, 0.5, 0.5}));
  CHECK_FALSE(inside(two, {1.5, -0.9, -0.9}));
  const scene::TriangleMesh hollow = test::together(cube, test::turned_over(cube), 0.5);
  CHECK_FALSE(inside(hollow, {0.1, 0.2, 0.3}));
  CHECK(inside(hollow, {0.1, 0.2, 0.7}));
  scene::TriangleMesh open = cube;
  open.triangles.pop_back();
  for (const dvec3& point : {dvec3(0.1, 0.2, 0.3), {0.1, 0.3, 0.2}}) CHECK_FALSE(inside(open, point));
  // A part that is open leaves the others closed.
  const scene::TriangleMesh both = test::together(open, cube, 1.0, {3.0, 0.0, 0.0});
  CHECK_FALSE(inside(both, {0.1, 0.3, 0.2}));
  CHECK(inside(both, {3.1, 0.2, 0.3}));
}

TEST_CASE(
    "a scene whose cloth goes through a body at the start is refused with the pairs, whatever self-collision "
    "is") {
  scene::Scene scene = over(cube_mesh(), {{0.0, 1.0, 0.5}, {}, 0.2});
  for (const auto& kind :
       {std::optional<scene::SelfCollision>{}, std::optional{scene::SelfCollision{0.01, 0.2}},
        std::optional{scene::SelfCollision{0.01, 0.2, scene::ContactKind::surface}}}) {
    scene.self_collision = kind;
    const Result<model::Model> made = model::build(scene);
    REQUIRE_FALSE(made);
    INFO(made.error().text());
    CHECK(made.error().where == "/colliders/1");
    CHECK(has(made.error().what, "crossings: edge "));
    CHECK(has(made.error().what, " of /cloths/0 (\"scarf\") meets triangle "));
    CHECK(has(made.error().what, " of /colliders/1 (\"body\") at ("));
    CHECK(has(made.error().facts, R"("collider":1)"));
    CHECK(has(made.error().facts, R"("cloth":0)"));
  }
}

TEST_CASE("cloth may start at a hair's breadth from a body, not on it") {
  scene::Scene scene = over(cube_mesh(), {{0.0, 0.75, 0.5}, {}, 0.25});  // its top at 1 m, as the sheet
  CHECK_FALSE(refusal(scene).empty());
  scene.cloths[0].transform.translate.y += 0x1p-22;
  CHECK(refusal(scene).empty());
  // Cloths may pass through each other where they do not collide.
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].transform = {{0.4, 0.9, 0.0}, {0.0, 0.0, 90.0}, 1.0};
  CHECK(refusal(scene).empty());
}

TEST_CASE("a scene whose cloth starts inside a closed body is refused, inside an open one it is not") {
  scene::TriangleMesh cube = cube_mesh();
  const scene::Transform large{{0.0, 1.0, 0.5}, {10.0, 20.0, 30.0}, 1.5};
  scene::Scene scene = over(cube, large);
  const std::string text = refusal(scene);
  INFO(text);
  CHECK(text.rfind("/colliders/1: ", 0) == 0);
  CHECK(has(text, "inside it vertex 0 of /cloths/0 (\"scarf\")"));
  CHECK(has(text, "a mesh that is open"));
  cube.triangles.pop_back();
  CHECK(refusal(over(cube, large)).empty());
  // Of two cloths only the second one is inside.
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[0].transform.translate.y = 5.0;
  scene.cloths[1].name = "lining";
  CHECK(has(refusal(scene), "of /cloths/1 (\"lining\")"));
}

TEST_CASE("a body is no solid of the kernels, and one that comes or moves starts the cloth anew") {
  const scene::Scene scene = over(cube_mesh());
  const sim::Plan plan = sim::plan(scene);
  CHECK(plan.solid_count() == 1);
  CHECK(plan.bodies == 1);
  scene::Scene changed = scene;
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::none);
  changed.colliders[1].name = "renamed";
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::none);
  changed.colliders[1].friction = 0.9;
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::uniform);
  changed = scene;
  std::get<scene::Body>(changed.colliders[1].shape).transform.translate.x = 1e-3;
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::cloth);
  changed = scene;
  changed.colliders[1].motion = scene::Linear{{1, 0, 0}};
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::cloth);
  changed = scene;
  changed.colliders.push_back(body_of(cube_mesh(), {{9, 9, 9}, {}, 1}));
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::cloth);
  changed = scene;
  changed.colliders.pop_back();
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::kernel);
  // Another copy of the same mesh is the same body.
  changed = over(cube_mesh());
  CHECK(sim::change_depth(scene, changed) == sim::ChangeDepth::none);
}

TEST_CASE("the ball around a body contains it and is not much larger") {
  const scene::Ball ball = scene::bounds(scene::Body{
      std::make_shared<const scene::TriangleMesh>(ball_mesh(2)), {{1.0, 2.0, 3.0}, {10.0, 20.0, 30.0}, 0.5}});
  CHECK(glm::distance(ball.center, dvec3(1, 2, 3)) < 0.02);
  CHECK((ball.radius >= 0.5 && ball.radius < 0.52));
}

TEST_CASE("a body's file has its vertices as floats and its triangles, in its own frame") {
  const std::string bytes = model::ply_bytes(cube_mesh(), "test");
  const Result<mesh::Mesh> read = mesh::read(bytes, "body.ply", {1 << 20, 100, 100});
  REQUIRE(read);
  CHECK(read->vertices == cube_mesh().vertices);
  CHECK(read->triangles == cube_mesh().triangles);
}
