// The typed scene: what the keys of a valid document become, and their defaults.
#include <algorithm>

#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"
#include "tests/catch.h"
#include "tests/unit/base_document.h"

using namespace clothlab;
using scene::json;
using test::base_document;

TEST_CASE(
    "finite elements have the material's numbers, one bending stiffness or three, and defaults for the "
    "rest") {
  json value = base_document();
  value["cloths"][0]["material"] =
      json::parse(R"({"model": "fem", "warp": 300, "weft": 200, "poisson": 0.2, "shear": 40, "bending": 2e-5,
                      "damping": 0.002, "grain": 30, "strain_limit": 0.2})");
  const auto all = std::get<scene::Fem>(scene::validate(value)->scene.cloths[0].material);
  CHECK(all == scene::Fem{300, 200, 0.2, 40, {2e-5, 2e-5, std::nullopt}, 0.002, 30, 0.2});
  value["cloths"][0]["material"]["bending"] = {{"warp", 1e-5}, {"weft", 3e-5}, {"twist", 2e-6}};
  const auto three = std::get<scene::Fem>(scene::validate(value)->scene.cloths[0].material);
  CHECK(three.bending == scene::Fem::Bending{1e-5, 3e-5, 2e-6});
  value["cloths"][0]["material"]["strain_limit"] = {{"warp", 0.1}, {"weft", 0.3}};
  CHECK(scene::validate(value)->scene.cloths[0].strain_limit() == scene::StrainLimit(0.1, 0.3));
  value["cloths"][0]["material"] = {{"model", "fem"}};
  const Result<scene::Document> plain = scene::validate(value);
  CHECK(std::get<scene::Fem>(plain->scene.cloths[0].material) == scene::Fem{});
  CHECK(plain->value["cloths"][0]["material"]["weft"] == 3801.0);
}

TEST_CASE("the lab leaves out what has no meaning for a scene, and refuses it if it is asked for by name") {
  json value = base_document();
  CHECK(scene::suited_methods(scene::validate(value)->scene, {})->size() == scene::methods.size());
  value["cloths"][0]["material"] = {{"model", "fem"}};
  const scene::Scene sheet = scene::validate(value)->scene;
  const std::vector<scene::Method> suited = *scene::suited_methods(sheet, {});
  CHECK(suited.size() == scene::methods.size() - 1);
  CHECK(std::count(suited.begin(), suited.end(), scene::Method::pbd) == 0);
  CHECK(scene::suited_methods(sheet, {scene::Method::vbd})->size() == 1);
  const auto refused = scene::suited_methods(sheet, {scene::Method::vbd, scene::Method::pbd});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "pbd");
}

TEST_CASE("every method can be named, and is the one the scene gets") {
  for (const scene::Method method : scene::methods) {
    INFO(scene::name(method));
    const auto named = scene::set_value(*scene::validate(base_document()),
                                        std::string("/solver/method=") + scene::name(method));
    REQUIRE(named);
    CHECK(named->scene.solver.method == method);
  }
}

TEST_CASE("the smallest document is a whole scene, with every default in its JSON") {
  const auto document = scene::validate(json::parse(R"({"version": 1, "cloths": [{"mesh": {"grid": {}}}]})"));
  REQUIRE(document);
  json expected = scene::load_preset("seed")->value;
  expected["name"] = "scene";
  expected["cloths"][0]["pins"] = json::array();
  expected["colliders"] = json::array();
  expected["self_collision"] = nullptr;
  expected["cloths"][0]["transform"]["translate"] = {0, 0, 0};
  CHECK(document->value == expected);
  CHECK(scene::validate(document->value)->value == document->value);
}

TEST_CASE("a strain limit is a number or null, and null takes it away") {
  const auto limited = scene::set_value(*scene::load_preset("seed"), "/cloths/0/material/strain_limit=0.1");
  REQUIRE(limited);
  CHECK(limited->scene.cloths[0].springs().strain_limit == std::optional(0.1));
  const auto free = scene::set_value(*limited, "/cloths/0/material/strain_limit=null");
  REQUIRE(free);
  CHECK_FALSE(free->scene.cloths[0].springs().strain_limit);
}

TEST_CASE("a start and weights are read, a seed is filled in, and null or an empty list takes them away") {
  const scene::Document document = *scene::validate(base_document());
  CHECK(document.value["cloths"][1]["start"] == json::parse(R"({"scatter": {"size": 0.5, "seed": 1}})"));
  CHECK(document.scene.cloths[1].start == scene::Start(scene::Scatter{0.5, 1}));
  CHECK(document.scene.cloths[1].weights == std::vector{scene::Weight{scene::AtVertex{1}, 0.5}});
  CHECK(scene::validate(document.value)->scene == document.scene);
  CHECK(document.scene.cloths[0].start == scene::Start());
  CHECK(document.scene.cloths[0].weights.empty());
  const auto flat = scene::set_value(document, "/cloths/1/start={\"scale\": [1, 0, -2]}");
  REQUIRE(flat);
  CHECK(flat->scene.cloths[1].start == scene::Start(scene::Stretch{{1, 0, -2}}));
  const auto plain =
      scene::apply_patch(*flat, json::parse(R"([{"op": "replace", "path": "/cloths/1/start", "value": null},
                             {"op": "replace", "path": "/cloths/1/weights", "value": []}])"));
  REQUIRE(plain);
  CHECK(plain->scene.cloths[1].start == scene::Start());
  CHECK(plain->scene.cloths[1].weights.empty());
}

TEST_CASE("the typed scene holds what the document says, directions normalised") {
  const scene::Scene scene = scene::validate(base_document())->scene;
  CHECK(std::get<scene::Grid>(scene.cloths[0].mesh).columns == 25);
  CHECK(scene.cloths[0].springs().structural == 20000);
  CHECK(std::get<scene::AtCorner>(scene.cloths[0].pins[1].at) == scene::AtCorner{24, 0});
  CHECK(std::get<scene::Oscillate>(scene.cloths[0].pins[1].motion).amplitude == 0.2);
  CHECK(std::get<scene::TriangleMesh>(scene.cloths[1].mesh).triangles[0] ==
        std::array<std::uint32_t, 3>{0, 1, 2});
  CHECK(scene.cloths[1].mass.kind == scene::Mass::Kind::area_density);
  CHECK(std::get<scene::Spin>(scene.cloths[1].pins[1].motion).degrees_per_second == 72);
  CHECK(std::get<scene::Plane>(scene.colliders[1].shape).normal == scene::dvec3(0, 1, 0));
  CHECK(scene.self_collision->thickness == 0.01);
  CHECK(scene.gravity == scene::dvec3(0, -9.8, 0));
}
