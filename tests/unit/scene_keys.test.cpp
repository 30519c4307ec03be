// Keys of the scene: their laws, what can be keyed, and what is refused with its place.
#include <limits>

#include "server/model/stability.h"
#include "server/scene/keys.h"
#include "tests/catch.h"
#include "tests/unit/base_document.h"

using namespace clothlab;
using glm::dvec3;
using scene::Ease;
using scene::json;
using test::base_document;

namespace {

scene::Key key_of(Ease ease, std::vector<double> times, std::vector<double> values) {
  scene::Key key{"/air_drag", ease, std::move(times)};
  for (const double value : values) key.values.emplace_back(value, 0.0, 0.0);
  return key;
}

/// A sheet of finite elements beside the springs and the triangle of the base document, and no wind.
json with_keys(const std::string& keys) {
  json value = base_document();
  json sheet = value["cloths"][0];
  sheet["name"] = "sheet";
  sheet["material"] = {{"model", "fem"}, {"warp", 300}, {"weft", 200}, {"poisson", 0.5}, {"bending", 1e-5}};
  value["cloths"].push_back(sheet);
  value["wind"] = nullptr;
  value["cloths"][1]["material"]["bend"] = 0;
  value["keys"] = json::parse(keys);
  return value;
}

Error refused(const std::string& keys) {
  const Result<scene::Document> document = scene::validate(with_keys(keys));
  INFO(keys);
  REQUIRE_FALSE(document);
  return document.error();
}

std::string key(const std::string& of, const std::string& value) {
  return R"([{"of": ")" + of + R"(", "at": [[0, )" + value + "]]}]";
}

}  // namespace

TEST_CASE("a key's value is that of its law at any time, and its ends' values before and after") {
  const scene::Key linear = key_of(Ease::linear, {1, 2, 4}, {10, 20, 0});
  CHECK(scene::value_at(linear, 0).x == 10);
  CHECK(scene::value_at(linear, 1).x == 10);
  CHECK(scene::value_at(linear, 1.25).x == 12.5);
  CHECK(scene::value_at(linear, 2).x == 20);
  CHECK(scene::value_at(linear, 3).x == 10);
  CHECK(scene::value_at(linear, 5).x == 0);
  const scene::Key smooth = key_of(Ease::smooth, {0, 1}, {0, 1});
  CHECK(scene::value_at(smooth, 0.25).x == 0.15625);  // 3/16 - 2/64
  CHECK(scene::value_at(smooth, 0.5).x == 0.5);
  const scene::Key step = key_of(Ease::step, {0, 0.3}, {1, 2});
  CHECK(scene::value_at(step, 0.2999).x == 1);
  // 3 * 0.1 is rounded up, 1 - 0.7 down to less than 0.3; both are steps at 0.3.
  REQUIRE(1.0 - 0.7 < 0.3 + 1e-15);
  CHECK(scene::value_at(step, std::nextafter(0.3, 0.0)).x == 2);
  CHECK(scene::value_at(step, 3 * 0.1).x == 2);
}

TEST_CASE("what changes without a new model can be keyed, in both models, and defaults are written out") {
  const char* const numbers[] = {"/air_drag",
                                 "/self_collision/friction",
                                 "/colliders/0/friction",
                                 "/colliders/0/restitution",
                                 "/cloths/0/material/structural",
                                 "/cloths/0/material/shear",
                                 "/cloths/0/material/bend",
                                 "/cloths/0/material/damping",
                                 "/cloths/2/material/warp",
                                 "/cloths/2/material/shear",
                                 "/cloths/2/material/bending",
                                 "/cloths/2/material/damping"};
  for (const char* of : numbers) {
    const Result<scene::Document> document =
        scene::validate(with_keys(key(of, std::string(of).ends_with("warp") ? "300" : "1")));
    INFO(of << (document ? "" : document.error().text()));
    REQUIRE(document);
    CHECK(document->scene.keys.size() == 1);
    CHECK(document->value["keys"][0]["ease"] == "linear");
  }
  CHECK(scene::validate(with_keys(key("/gravity", "[0,1,2]"))));
  const Result<scene::Document> pin = scene::validate(with_keys(key("/cloths/0/pins/1/held", "true")));
  REQUIRE(pin);
  CHECK(pin->value["keys"][0]["ease"] == "step");
  for (const char* of : {"velocity", "gust", "gust_frequency", "drag", "lift"}) {
    json value = base_document();
    value["keys"] =
        json::parse(key(std::string("/wind/") + of, std::string(of) == "velocity" ? "[1,0,0]" : "1"));
    CHECK(scene::validate(value));
  }
}

TEST_CASE("what cannot be keyed is refused at its pointer, with why and what to take instead") {
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"/wind/velocity", "wind is null"},
      {"/solver/dt", "how steps are taken"},
      {"/solver/iterations", "one solver"},
      {"/cloths/0/mass/per_vertex", "/gravity"},
      {"/cloths/0/mesh", "made of"},
      {"/cloths/0/pins/0/motion", "its motion"},
      {"/cloths/0/pins/2/held", "the cloth has 2"},
      {"/cloths/3/material/damping", "there are 3"},
      {"/cloths/00/material/damping", "there are 3"},
      {"/cloths/0/material/warp", "the model springs"},
      {"/cloths/2/material/structural", "the model fem"},
      {"/cloths/2/material/poisson", "the model fem"},
      {"/cloths/1/material/bend", "a stiffness of 0"},
      {"/colliders/0/sphere/center", "its motion"},
      {"/colliders/9/friction", "there are"},
      {"/self_collision/thickness", "neighbours"},
      {"/gravity/1", "/gravity, /air_drag"},
      {"/name", "/gravity, /air_drag"},
      {"gravity", "/gravity, /air_drag"},
      {"", "/gravity, /air_drag"},
  };
  for (const auto& [of, says] : rows) {
    const Error error = refused(key(of, "1"));
    INFO(of << ": " << error.text());
    CHECK(error.where == "/keys/0/of");
    CHECK(error.what.find(of) != std::string::npos);
    CHECK_THAT(error.text(), ContainsSubstring(says));
  }
}

TEST_CASE("every value of a key is of the type and the range of what it is of, or refused at its own place") {
  const auto where = [](const std::string& keys) { return refused(keys).where; };
  CHECK(where(R"([{"of": "/air_drag", "at": [[0, 1], [1, -1]]}])") == "/keys/0/at/1/1");
  CHECK(where(R"([{"of": "/air_drag", "at": [[0, true]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/air_drag", "at": [[0, [1, 0, 0]]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/gravity", "at": [[0, 1]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/gravity", "at": [[0, [0, 2e6, 0]]]}])") == "/keys/0/at/0/1/1");
  CHECK(where(R"([{"of": "/colliders/0/restitution", "at": [[0, 1.1]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/cloths/0/material/bend", "at": [[0, 1], [2, 0]]}])") == "/keys/0/at/1/1");
  CHECK(where(R"([{"of": "/cloths/0/pins/0/held", "at": [[0, 1]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/cloths/0/pins/0/held", "at": [[0, false]]}])") == "/keys/0/at/0/1");
  CHECK(where(R"([{"of": "/cloths/0/pins/0/held", "at": [[0, true], [1, false], [2, true]]}])") ==
        "/keys/0/at/2/1");
  CHECK(where(R"([{"of": "/cloths/0/pins/0/held", "at": [[0, true]], "ease": "linear"}])") == "/keys/0/ease");
  CHECK(where(R"([{"of": "/air_drag", "at": [[-1, 1]]}])") == "/keys/0/at/0/0");
  CHECK(where(R"([{"of": "/air_drag", "at": [[1, 1], [1, 2]]}])") == "/keys/0/at/1/0");
  CHECK(where(R"([{"of": "/air_drag", "at": []}])") == "/keys/0/at");
  CHECK(where(R"([{"of": "/air_drag", "at": [[0]]}])") == "/keys/0/at/0");
  CHECK(where(R"([{"of": "/air_drag", "at": [[0, 1]], "ease": "quick"}])") == "/keys/0/ease");
  CHECK(where(R"([{"at": [[0, 1]]}])") == "/keys/0/of");
  CHECK(where(R"([{"of": "/air_drag", "at": [[0, 1]]}, {"of": "/air_drag", "at": [[0, 1]]}])") ==
        "/keys/1/of");
  // 0.5^2 = 0.25 is not below 40 / 200.
  CHECK(where(R"([{"of": "/cloths/2/material/warp", "at": [[0, 300], [1, 40]]}])") == "/keys/0/at");
}

TEST_CASE("the longest stable step of a scene is that of its keys' stiffest and most damped values") {
  const auto limit = [](const json& value) {
    const Result<scene::Document> document = scene::validate(value);
    REQUIRE(document);
    const Result<model::Model> model = model::build(document->scene);
    REQUIRE(model);
    return model::dt_limit_bound(*model, document->scene);
  };
  json value = scene::load_preset("seed")->value;
  const double plain = limit(value);
  value["keys"] =
      json::parse(R"([{"of": "/cloths/0/material/structural", "at": [[0, 100], [5, 8e4], [9, 10]]}])");
  const double keyed = limit(value);
  value["keys"] = json::array();
  value["cloths"][0]["material"]["structural"] = 8e4;
  CHECK(keyed == limit(value));
  CHECK(keyed < 0.8 * plain);
}
