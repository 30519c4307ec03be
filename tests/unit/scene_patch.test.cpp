// Patches: RFC 7396, RFC 6902 and `--set`. After any of them the scene is still valid.
#include <random>

#include "server/scene/document.h"
#include "server/scene/pointer.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::apply_patch;
using scene::json;

namespace {

scene::Document seed() {
  return *scene::load_preset("seed");
}

Result<scene::Document> patched(const char* patch) {
  return apply_patch(seed(), json::parse(patch));
}

}  // namespace

TEST_CASE("a merge patch changes what it names and nothing else") {
  const auto document = patched(R"({"solver": {"dt": 0.0005}, "gravity": [0, -1.6, 0]})");
  REQUIRE(document);
  CHECK(document->scene.solver.dt == 0.0005);
  CHECK(document->scene.gravity.y == -1.6);
  scene::Scene back = document->scene;
  back.solver.dt = 0.001;
  back.gravity.y = -9.8;
  CHECK(back == seed().scene);
}

TEST_CASE("null in a merge patch brings back the default, which turns self-collision off") {
  CHECK_FALSE(patched(R"({"self_collision": null})")->scene.self_collision);
  CHECK(patched(R"({"self_collision": null})")->value["self_collision"].is_null());
  CHECK(patched(R"({"solver": {"dt": null}})")->scene.solver.dt == 0.001);
  CHECK(patched(R"({"cloths": null})").error().where == "/cloths");
  const auto off = patched(R"({"self_collision": null})");
  const auto on = apply_patch(*off, json::parse(R"({"self_collision": {}})"));
  CHECK(on->scene.self_collision->thickness == 0.01);
}

TEST_CASE("numbers keep the form their author gave them") {
  const std::string text = seed().value.dump();
  CHECK(text.find("\"per_vertex\":0.1}") != std::string::npos);
  CHECK(text.find("99999") == std::string::npos);
  CHECK(patched(R"({"gravity": [0, -1, 0.3]})")->value["gravity"].dump() == "[0,-1,0.3]");
}

TEST_CASE("each operation of RFC 6902 does its work") {
  const auto add = patched(R"([{"op": "add", "path": "/colliders/0", "value":
      {"plane": {"point": [0,0,0], "normal": [0,1,0]}}}, {"op": "add", "path": "/colliders/-", "value":
      {"name": "last", "sphere": {"center": [0,0,0], "radius": 1}}}])");
  REQUIRE(add);
  REQUIRE(add->scene.colliders.size() == 3);
  CHECK(add->scene.colliders[0].name == "collider");
  CHECK(add->scene.colliders[1].name == "ball");
  CHECK(add->scene.colliders[2].name == "last");
  CHECK(patched(R"([{"op": "remove", "path": "/colliders/0"}])")->scene.colliders.empty());
  CHECK(patched(R"([{"op": "replace", "path": "/solver/dt", "value": 0.002}])")->scene.solver.dt == 0.002);
  CHECK(patched(R"([{"op": "test", "path": "/solver/dt", "value": 1e-3}])"));
  const auto copy = patched(R"([{"op": "copy", "from": "/cloths/0", "path": "/cloths/-"},
                               {"op": "replace", "path": "/cloths/1/name", "value": "second"}])");
  CHECK(copy->scene.cloths.size() == 2);
  const auto move = patched(R"([{"op": "move", "from": "/cloths/0/pins/0", "path": "/cloths/0/pins/1"}])");
  CHECK(std::get<scene::AtCorner>(move->scene.cloths[0].pins[0].at).column == 24);
  CHECK(patched(R"([{"op": "move", "from": "/solver", "path": "/solver"}])")->value == seed().value);
  CHECK(patched("[]")->value == seed().value);
}

TEST_CASE("an operation that cannot be carried out is named by its place in the patch") {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {R"([3])", "/patch/0"},
      {R"([{"path": "/solver/dt"}])", "/patch/0/op"},
      {R"([{"op": "twist", "path": ""}])", "/patch/0/op"},
      {R"([{"op": "remove"}])", "/patch/0/path"},
      {R"([{"op": "remove", "path": "solver"}])", "/patch/0/path"},
      {R"([{"op": "remove", "path": "/a~2"}])", "/patch/0/path"},
      {R"([{"op": "remove", "path": ""}])", "/patch/0/path"},
      {R"([{"op": "add", "path": "/air_drag"}])", "/patch/0/value"},
      {R"([{"op": "replace", "path": "/wing", "value": 1}])", "/patch/0/path"},
      {R"([{"op": "add", "path": "/colliders/2", "value": 1}])", "/patch/0/path"},
      {R"([{"op": "add", "path": "/colliders/00", "value": 1}])", "/patch/0/path"},
      {R"([{"op": "add", "path": "/wing/tip", "value": 1}])", "/patch/0/path"},
      {R"([{"op": "add", "path": "/air_drag/x", "value": 1}])", "/patch/0/path"},
      {R"([{"op": "copy", "path": "/air_drag"}])", "/patch/0/from"},
      {R"([{"op": "copy", "from": "/wing", "path": "/air_drag"}])", "/patch/0/from"},
      {R"([{"op": "move", "from": "/solver", "path": "/solver/dt"}])", "/patch/0/from"},
      {R"([{"op": "test", "path": "/solver/dt", "value": 1e-3}, {"op": "test", "path": "/name", "value": "x"}])",
       "/patch/1/value"},
  };
  for (const auto& [patch, where] : cases) {
    INFO(patch);
    const auto document = patched(patch);
    REQUIRE_FALSE(document);
    CHECK(document.error().where == where);
  }
  CHECK(patched("3").error().where == "/patch");
}

TEST_CASE("a patch whose outcome is no valid scene is refused by the place in the scene") {
  CHECK(patched(R"({"solver": {"dt": -1}})").error().where == "/solver/dt");
  CHECK(patched(R"([{"op": "replace", "path": "", "value": 3}])").error().where.empty());
  CHECK(patched(R"([{"op": "remove", "path": "/cloths/0"}])").error().where == "/cloths");
}

TEST_CASE("copying the scene into itself again and again is stopped before memory runs out") {
  json patch = json::array();
  for (int i = 0; i < 1000; ++i)
    patch.push_back({{"op", "copy"}, {"from", ""}, {"path", "/a" + std::to_string(i)}});
  CHECK_FALSE(apply_patch(seed(), patch));
  for (std::size_t i = 0; i <= scene::max_patch_operations; ++i)
    patch.push_back({{"op", "test"}, {"path", "/solver/dt"}, {"value", 0.001}});
  CHECK(apply_patch(seed(), patch).error().where == "/patch");
}

TEST_CASE("a long text copied again and again is stopped before memory runs out") {
  json patch =
      json::array({{{"op", "add"}, {"path", "/a"}, {"value", json::array({std::string(60000, 'x')})}}});
  for (int i = 0; i < 14; ++i)  // doubled so often: a thousand million bytes
    patch.push_back({{"op", "copy"}, {"from", "/a"}, {"path", "/a/-"}});
  const auto refused = apply_patch(seed(), patch);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "copies of more than 16777216 bytes of JSON");
  CHECK(refused.error().where.starts_with("/patch/"));
}

TEST_CASE("putting a thousand values before a long list is stopped before it takes seconds") {
  json patch = json::array({{{"op", "add"}, {"path", "/a"}, {"value", json(std::vector<int>(1000, 0))}}});
  for (int i = 0; i < 1000; ++i) patch.push_back({{"op", "add"}, {"path", "/a/0"}, {"value", 0}});
  json target = seed().value;
  CHECK(scene::patched(target, patch));
  scene::PatchLimits limits;
  limits.shifted_values = 1000 * 1000;
  const auto refused = scene::patched(target, patch, limits);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what == "shifts of more than 1000000 values of lists");
}

TEST_CASE("the size of a document is that of its compact text, to the byte") {
  json odd = seed().value;
  odd["x"] = {"a\"b\n\u0001", "\xff",        -1,        1e-300, 0.1, nullptr, true,
              json::object(), json::array(), "\xc3\xa9"};
  const std::size_t bytes = odd.dump(-1, ' ', false, json::error_handler_t::replace).size();
  CHECK(scene::json_bytes(odd) == bytes);
  CHECK(scene::check_bytes(odd));
  odd["y"] = std::string(scene::max_document_bytes - bytes - 7, ' ');
  CHECK(scene::check_bytes(odd));
  odd["y"] = odd["y"].get<std::string>() + " ";
  const Status large = scene::check_bytes(odd);
  REQUIRE_FALSE(large);
  CHECK(large.error().what == "a scene of 3145729 bytes of JSON, with its defaults");
}

TEST_CASE("moving a large part is allowed, moving it a thousand times is stopped before it takes minutes") {
  json patch = json::array();
  // Each copy contains the ones before: some hundred thousand values in all.
  for (int i = 0; i < 12; ++i)
    patch.push_back({{"op", "copy"}, {"from", ""}, {"path", "/a" + std::to_string(i)}});
  patch.push_back({{"op", "move"}, {"from", "/a11"}, {"path", "/b"}});
  CHECK(apply_patch(seed(), patch).error().where.rfind("/patch", 0) == std::string::npos);
  for (int i = 0; i < 1000; ++i)
    patch.push_back({{"op", "move"}, {"from", i % 2 ? "/c" : "/b"}, {"path", i % 2 ? "/b" : "/c"}});
  const auto refused = apply_patch(seed(), patch);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().what.rfind("moves of more than", 0) == 0);
}

TEST_CASE("a patch cannot nest values deeper than a message may") {
  json patch = json::array({{{"op", "add"}, {"path", "/a"}, {"value", json::object()}}});
  std::string path = "/a";
  for (int i = 0; i < 40; ++i) {
    path += "/b";
    patch.push_back({{"op", "add"}, {"path", path}, {"value", json::object()}});
  }
  const auto document = apply_patch(seed(), patch);
  REQUIRE_FALSE(document);
  CHECK(document.error().what == "a value nested too deep");
}

TEST_CASE("after any sequence of random patches the document is valid and in step with its scene") {
  std::mt19937 random(1);
  const std::vector<const char*> places = {"/solver/dt",         "/solver",
                                           "/gravity",           "/gravity/1",
                                           "/cloths/0",          "/cloths/0/mesh/grid/columns",
                                           "/cloths/-",          "/cloths/0/pins",
                                           "/cloths/0/pins/0",   "/cloths/0/pins/-",
                                           "/colliders/0",       "/colliders/-",
                                           "/self_collision",    "/air_drag",
                                           "/cloths/0/name",     "/colliders/0/name",
                                           "/cloths/0/material", ""};
  const std::vector<json> values = {
      0, 1, -1, 0.5, 1e-3, nullptr, "x", "corner:0,0", json::object(), {0, 1, 0}, 30, 1e300};
  const std::vector<const char*> operations = {"add", "remove", "replace", "move", "copy", "test"};
  const auto pick = [&](const auto& from) { return from[random() % from.size()]; };
  scene::Document document = seed();
  int accepted = 0;
  for (int round = 0; round < 4000; ++round) {
    json patch = json::array();
    for (auto count = random() % 3 + 1; count > 0; --count)
      patch.push_back({{"op", pick(operations)},
                       {"path", pick(places)},
                       {"from", pick(places)},
                       {"value", pick(values)}});
    const json before = document.value;
    const Result<scene::Document> next = apply_patch(document, patch);
    CHECK(document.value == before);
    if (!next) {
      CHECK_FALSE(next.error().remedy.empty());
      continue;
    }
    document = round % 50 == 0 ? seed() : *next;
    ++accepted;
    const Result<scene::Document> again = scene::validate(document.value);
    REQUIRE(again);
    REQUIRE(*again == document);
  }
  CHECK(accepted > 100);
}

TEST_CASE("an assignment of --set changes one value: JSON where it is JSON, else a text") {
  const auto set = [](const char* assignment) { return scene::set_value(seed(), assignment); };
  CHECK(set("/solver/dt=0.0005")->scene.solver.dt == 0.0005);
  CHECK(set("/cloths/0/texture=checker")->scene.cloths[0].texture == "checker");
  CHECK(set("/cloths/0/texture=\"plain\"")->scene.cloths[0].texture == "plain");
  CHECK(set("/name=a=b")->scene.name == "a=b");
  CHECK_FALSE(set("/self_collision=null")->scene.self_collision);
  CHECK(set("/self_collision/thickness=0.02")->scene.self_collision->thickness == 0.02);
  CHECK(set("/colliders/-={\"plane\":{\"point\":[0,0,0],\"normal\":[0,1,0]}}")->scene.colliders.size() == 2);
  CHECK(set("/cloths/0/pins/1/motion=null")->scene.cloths[0].pins[1].motion == scene::Motion{});

  CHECK(set("dt=1").error().where == "--set");
  CHECK(set("/solver/dt").error().where == "--set");
  CHECK(set("=1").error().where == "--set");
  CHECK(set("/solver/dt=fast").error().where == "/solver/dt");
  CHECK(set("/solver/dtt=1").error().where == "/solver/dtt");
  CHECK(set("/colliders/7/friction=1").error().where == "/colliders/7/friction");
  CHECK(set("/air_drag/x=1").error().where == "/air_drag/x");
  CHECK(set("/gravity=[0,").error().where.rfind("/gravity", 0) == 0);
}
