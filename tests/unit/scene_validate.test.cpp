// The scene document, rule by rule: values that just pass and values that just fail.
#include <limits>

#include "server/scene/document.h"
#include "server/scene/ranges.h"
#include "tests/catch.h"
#include "tests/unit/base_document.h"

using namespace clothlab;
using scene::json;
using test::base_document;

namespace {

/// The pointer of the error when `pointer` is set to `text`; "valid" when there is none.
std::string verdict(const std::string& pointer, const std::string& text) {
  json value = base_document();
  value[json::json_pointer(pointer)] = json::parse(text);
  const Result<scene::Document> document = scene::validate(value);
  return document ? "valid" : document.error().where;
}

struct Rule {
  const char* pointer;
  std::vector<const char*> good, bad;
};

const std::vector<Rule> rules = {
    {"/version", {"1", "1.0"}, {"0", "2", "\"1\"", "null"}},
    {"/name", {"\"x\"", "\"\\u00e9\""}, {"\"\"", "7", "\"a\\nb\"", "null"}},
    {"/gravity/1", {"0", "-1e6", "1e6"}, {"-1.001e6", "1.001e6", "\"0\"", "null"}},
    {"/gravity", {"[0,0,0]"}, {"[0,0]", "[0,0,0,0]", "{}", "0"}},
    {"/cloths/0/mesh/grid/columns", {"25", "1024", "30.0"}, {"1", "1025", "25.5", "\"25\"", "-3"}},
    {"/cloths/0/mesh/grid/width", {"1e-6", "1e6"}, {"0", "-1", "9e-7", "1.1e6"}},
    {"/cloths/0/transform/scale", {"1e-6", "1e6"}, {"0", "-1", "1.1e6"}},
    {"/cloths/0/mass/per_vertex", {"1e-9", "1e6"}, {"0", "-0.1", "9e-10", "1.1e6", "null"}},
    {"/cloths/1/mass/area_density", {"1e-9", "1e6"}, {"0", "-0.1", "9e-10", "1.1e6"}},
    {"/cloths/0/material/structural", {"0", "1e12"}, {"-1e-9", "1.1e12", "true"}},
    {"/cloths/0/material/shear", {"0", "1e12"}, {"-1e-9", "1.1e12"}},
    {"/cloths/0/material/bend", {"0", "1e12"}, {"-1e-9", "1.1e12"}},
    {"/cloths/0/material/damping", {"0", "1e9"}, {"-1e-9", "1.1e9"}},
    {"/cloths/0/material/strain_limit",
     {"null", "0.001", "10"},
     {"0", "-0.1", "9e-4", "10.1", "\"0.1\"", "false", "[]"}},
    {"/cloths/0/material/fabric", {"\"cotton\"", "\"tango\""}, {"\"velvet\"", "\"\"", "null", "1"}},
    {"/cloths/0/color", {"\"#00ff7F\""}, {"\"#00ff7\"", "\"00ff7f0\"", "\"red\"", "\"#00fg7f\"", "\"\""}},
    {"/cloths/0/texture", {"\"plain\"", "\"checker\"", "\"stripes\""}, {"\"velvet\"", "\"\"", "1"}},
    {"/cloths/0/pins/0/at",
     {"\"corner:24,24\"", "\"vertex:624\"", "\"edge:row:24\"", "\"edge:column:0\""},
     {"\"corner:25,0\"", "\"corner:0,25\"", "\"vertex:625\"", "\"edge:row:25\"", "\"edge:column:25\"",
      "\"corner:0\"", "\"corner:00,0\"", "\"corner:-1,0\"", "\"corner:0,0,0\"", "\"vertex:\"", "\"edge:0\"",
      "\"middle\"", "3"}},
    {"/cloths/1/pins/0/at", {"\"vertex:0\""}, {"\"vertex:3\"", "\"corner:0,0\"", "\"edge:row:0\""}},
    {"/cloths/1/pins/1/at/box", {"[[0,0,0],[0,0,0]]"}, {"[[0,0,1],[0,0,0]]", "[[0,0,0]]", "[]"}},
    {"/cloths/0/weights",
     {"[]", R"([{"at": "edge:row:24", "mass": 1e-9}, {"at": "vertex:0", "mass": 1e6}])",
      R"([{"at": {"box": [[-1,0,-1],[1,2,2]]}, "mass": 1}])"},
     {"null", "{}", "1"}},
    {"/cloths/1/weights/0",
     {R"({"at": "vertex:2", "mass": 1})"},
     {"null", R"({"at": "vertex:2", "mass": 1, "motion": null})"}},
    {"/cloths/1/weights/0/at",
     {"\"vertex:0\"", R"({"box": [[-1,-1,-1],[1,1,1]]})"},
     {"\"vertex:3\"", "\"corner:0,0\"", R"({"box": [[1,0,0],[0,0,0]]})", "null"}},
    {"/cloths/1/weights/0/mass", {"1e-9", "1e6"}, {"0", "-1", "9e-10", "1.1e6", "null"}},
    {"/cloths/0/start",
     {"null", R"({"scatter": {"size": 1}})", R"({"scale": [1, -1e3, 1e3]})"},
     {"{}", "true", "[]", "\"scatter\"", R"({"scatter": {"size": 1}, "scale": [0,0,0]})"}},
    {"/cloths/1/start/scatter", {R"({"size": 1e-6, "seed": 0})"}, {"null", "1", "[]"}},
    {"/cloths/1/start/scatter/size", {"1e-6", "1e6"}, {"0", "-1", "1.1e6", "null"}},
    {"/cloths/1/start/scatter/seed", {"0", "1e9", "7.0"}, {"-1", "1.5", "1.1e9", "null"}},
    {"/cloths/1/start/scatter/sead", {}, {"1"}},
    {"/cloths/0/start",
     {R"({"dress": 1e-3})", R"({"dress": 10})"},
     {R"({"dress": 0})", R"({"dress": 10.1})", R"({"dress": null})", R"({"dress": 1, "scale": [1, 1, 1]})"}},
    {"/cloths/0/pins/0/place", {"[0,0,0]", "[-1e6,0,1e6]"}, {"[0,0]", "[1.1e6,0,0]", "null", "\"there\""}},
    {"/cloths/0/pins/0/motion/oscillate/frequency", {"0", "1e4"}, {"-1", "1.1e4"}},
    {"/cloths/0/pins/0/motion/oscillate/axis", {"[0,0,1e-6]"}, {"[0,0,0]", "[0,-0.0,0]", "[1,0]"}},
    {"/colliders/0/sphere/radius", {"1e-6", "1e6"}, {"0", "-1", "1.1e6"}},
    {"/colliders/0/friction", {"0", "10"}, {"-0.1", "10.1"}},
    {"/colliders/0/restitution", {"0", "1"}, {"-0.1", "1.1"}},
    {"/colliders/1/plane/normal", {"[0,0,-3]"}, {"[0,0,0]"}},
    {"/colliders/2/capsule/radius", {"1e-6", "1e6"}, {"0", "-1", "1.1e6", "null"}},
    {"/colliders/2/capsule/b", {"[0,0,0]", "[1e6,0,0]"}, {"[0,0]", "[1.1e6,0,0]", "null"}},
    {"/colliders/2/capsule", {}, {R"({"a": [0,0,0], "radius": 1})", R"({"from": [0,0,0]})", "null"}},
    {"/colliders/3/box/half", {"[1e-6,1,1e6]"}, {"[0,1,1]", "[1,-1,1]", "[1,1]", "1", "[1,1,1.1e6]"}},
    {"/colliders/3/box/rotate", {"[0,0,720]", "[-1e6,0,0]"}, {"[0,0]", "45", "[1.1e6,0,0]", "null"}},
    {"/colliders/3/box", {}, {R"({"center": [0,0,0]})", R"({"half": [1,1,1]})", "[]"}},
    {"/self_collision/thickness", {"1e-6", "10"}, {"0", "11"}},
    {"/self_collision", {"null", "{}"}, {"true", "0.01"}},
    {"/self_collision/kind", {"\"points\"", "\"surface\""}, {"\"volume\"", "1", "null"}},
    {"/wind", {"null", R"({"velocity": [0,0,0]})"}, {"true", "{}", "2"}},
    {"/wind/velocity", {"[-1e3,0,1e3]"}, {"[1e3,0,1.1e3]", "[1,2]", "2", "[null,0,0]"}},
    {"/wind/gust", {"0", "10"}, {"-0.1", "10.1"}},
    {"/wind/gust_frequency", {"0", "1e4"}, {"-1", "1.1e4"}},
    {"/wind/drag", {"0", "100"}, {"-1", "101", "null"}},
    {"/wind/lift", {"0", "100"}, {"-0.01", "101"}},
    {"/wind/drug", {}, {"1"}},
    {"/air_drag", {"0", "1e6"}, {"-0.1", "1.1e6"}},
    {"/solver/dt", {"1e-9", "1"}, {"0", "-0.001", "1.001", "null"}},
    {"/solver/iterations", {"1", "10000"}, {"0", "10001", "1.5"}},
    {"/solver/tolerance", {"1e-12", "1"}, {"0", "1.1"}},
    {"/cloths/1/mesh/triangles/0/2", {"2.0"}, {"3", "-1", "0.5"}},
};

}  // namespace

TEST_CASE(
    "every rule of the scene lets its last good value pass and stops its first bad one at its own place") {
  for (const Rule& rule : rules) {
    for (const char* good : rule.good) {
      INFO(rule.pointer << " = " << good);
      CHECK(verdict(rule.pointer, good) == "valid");
    }
    for (const char* bad : rule.bad) {
      INFO(rule.pointer << " = " << bad);
      CHECK(verdict(rule.pointer, bad).rfind(rule.pointer, 0) == 0);
    }
  }
}

TEST_CASE("what makes no sheet is refused with its place: Poisson's ratio, negative moduli, PBD") {
  const auto refused = [](const char* material, const char* method) {
    json value = base_document();
    value["cloths"][0]["material"] = json::parse(material);
    value["cloths"][0]["material"]["model"] = "fem";
    value["solver"]["method"] = method;
    const Result<scene::Document> document = scene::validate(value);
    REQUIRE_FALSE(document);
    return document.error().text();
  };
  // 0.9^2 = 0.81 is above 3 / 4.
  CHECK_THAT(refused(R"({"warp": 300, "weft": 400, "poisson": 0.9})", "verlet"),
             ContainsSubstring("/cloths/0/material/poisson") && ContainsSubstring("0.9") &&
                 ContainsSubstring("0.866"));
  CHECK_THAT(refused(R"({"warp": -1})", "verlet"), ContainsSubstring("/cloths/0/material/warp"));
  CHECK_THAT(refused(R"({"bending": {"warp": 1e-5}})", "verlet"),
             ContainsSubstring("/cloths/0/material/bending/weft"));
  CHECK_THAT(refused(R"({"strain_limit": {"warp": 0.1}})", "verlet"),
             ContainsSubstring("/cloths/0/material/strain_limit/weft"));
  CHECK_THAT(refused(R"({"strain_limit": {"warp": 0.1, "weft": 0}})", "verlet"),
             ContainsSubstring("/cloths/0/material/strain_limit/weft"));
  CHECK_THAT(refused(R"({"strain_limit": 11})", "verlet"),
             ContainsSubstring("/cloths/0/material/strain_limit"));
  CHECK_THAT(refused(R"({"structural": 100})", "verlet"), ContainsSubstring("/cloths/0/material/structural"));
  CHECK_THAT(refused("{}", "pbd"), ContainsSubstring("/solver/method") && ContainsSubstring("xpbd"));
}

TEST_CASE("an unknown key is named with an escaped pointer, the allowed keys and the nearest of them") {
  json value = base_document();
  value["solver"]["d/t~"] = 1;
  Error error = scene::validate(value).error();
  CHECK(error.where == "/solver/d~1t~0");
  CHECK(error.remedy.find("\"dt\", \"iterations\"") != std::string::npos);
  value = base_document();
  value["cloths"][0]["material"]["sheer"] = 1;
  error = scene::validate(value).error();
  CHECK(error.where == "/cloths/0/material/sheer");
  CHECK(error.remedy.find("did you mean \"shear\"?") != std::string::npos);
}

TEST_CASE("an error shows the value found as JSON, shortened if long and never inside a character") {
  json value = base_document();
  value["solver"]["dt"] = {{"a", 1}};
  CHECK(scene::validate(value).error().what == R"({"a":1})");
  std::string text = "a";
  for (int i = 0; i < 1000; ++i) text += "\u00e9";
  value["solver"]["dt"] = text;
  const std::string found = scene::validate(value).error().what;
  CHECK(found.size() < 100);
  CHECK_NOTHROW(json(found).dump());
}

TEST_CASE("a name has up to 64 characters however many bytes they take") {
  std::string name;
  for (int i = 0; i < 64; ++i) name += "\u00e9";
  CHECK(verdict("/name", json(name).dump()) == "valid");
  CHECK(verdict("/name", json(name + "x").dump()) == "/name");
}

TEST_CASE("two cloths or two colliders never share a name") {
  CHECK(verdict("/cloths/1/name", R"("cloth")") == "/cloths/1/name");
  CHECK(verdict("/colliders/1/name", R"("ball")") == "/colliders/1/name");
  CHECK(verdict("/colliders/1/name", R"("cloth")") == "valid");
}

TEST_CASE("a mesh, a mass, a motion and a shape are each exactly one of their kinds") {
  CHECK(verdict("/cloths/0/mesh/vertices", "[[0,0,0],[0,0,1],[1,0,0]]") == "/cloths/0/mesh");
  CHECK(verdict("/cloths/0/mesh", "{}") == "/cloths/0/mesh");
  CHECK(verdict("/cloths/1/mesh", R"({"vertices": [[0,0,0],[0,0,1],[1,0,0]]})") ==
        "/cloths/1/mesh/triangles");
  CHECK(verdict("/cloths/1/mesh", R"({"triangles": [[0,1,2]]})") == "/cloths/1/mesh/vertices");
  CHECK(verdict("/cloths/0/mass/area_density", "0.1") == "/cloths/0/mass");
  CHECK(verdict("/cloths/0/mass", "{}") == "/cloths/0/mass");
  CHECK(verdict("/cloths/0/pins/0/motion/linear", R"({"velocity": [0,0,0]})") == "/cloths/0/pins/0/motion");
  CHECK(verdict("/colliders/0/plane", R"({"point": [0,0,0], "normal": [0,1,0]})") == "/colliders/0");
}

TEST_CASE("a triangle has three different vertices of its mesh") {
  CHECK(verdict("/cloths/1/mesh/triangles/0", "[0,1,1]") == "/cloths/1/mesh/triangles/0");
  CHECK(verdict("/cloths/1/mesh/triangles/0", "[0,1]") == "/cloths/1/mesh/triangles/0");
  CHECK(verdict("/cloths/1/mesh/triangles/0", "[0,1,3]") == "/cloths/1/mesh/triangles/0/2");
}

TEST_CASE("all cloths together have at most 2^20 vertices") {
  json value = base_document();
  value["cloths"][0]["mesh"]["grid"]["columns"] = 1024;
  value["cloths"][0]["mesh"]["grid"]["rows"] = 1023;
  CHECK(scene::validate(value));
  value["cloths"][0]["mesh"]["grid"]["rows"] = 1024;  // and three more vertices in the triangle
  CHECK(scene::validate(value).error().where == "/cloths/1/mesh");
}

TEST_CASE("a number that is not finite never becomes part of a scene") {
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    json value = base_document();
    value["gravity"][1] = x;
    CHECK(scene::validate(value).error().where == "/gravity/1");
  }
}

TEST_CASE(
    "a time step, a stiffness or a mesh that no method can use is refused in words that say what one can") {
  struct Refusal {
    const char* assignment;
    const char *where, *found, *allowed;
  };
  const char *step = "a number from 1e-09 to 1 [s]", *stiffness = "a number from 0 to 1e+12 [N/m]";
  const char* three = "an array of 3 to 1048576 elements";
  const std::vector<Refusal> refusals = {
      {"/solver/dt=0", "/solver/dt", "0", step},
      {"/solver/dt=-0.001", "/solver/dt", "-0.001", step},
      {"/solver/dt=1e9", "/solver/dt", "1000000000.0", step},
      {"/solver/dt=NaN", "/solver/dt", "\"NaN\"", step},
      {"/solver/dt=1e-999", "/solver/dt", "0.0", step},
      {"/cloths/0/material/structural=1e30", "/cloths/0/material/structural", "1e+30", stiffness},
      {"/cloths/0/material/bend=-1e-30", "/cloths/0/material/bend", "-1e-30", stiffness},
      {"/cloths/0/material/shear=Infinity", "/cloths/0/material/shear", "\"Infinity\"", stiffness},
      {"/cloths/0/mass/per_vertex=1e-30", "/cloths/0/mass/per_vertex", "1e-30",
       "a number from 1e-09 to 1e+06 [kg]"},
      {"/cloths/0/mesh/grid/rows=1", "/cloths/0/mesh/grid/rows", "1",
       "a whole number from 2 to 1024 [vertices]"},
      {"/cloths/1/mesh={\"vertices\":[[0,0,0],[1,0,0]],\"triangles\":[[0,1,0]]}", "/cloths/1/mesh/vertices",
       "2 elements", three},
  };
  const scene::Document document = *scene::validate(base_document());
  for (const Refusal& refusal : refusals) {
    INFO(refusal.assignment);
    const Result<scene::Document> refused = scene::set_value(document, refusal.assignment);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().where == refusal.where);
    CHECK(refused.error().what == refusal.found);
    CHECK(refused.error().remedy == refusal.allowed);
  }
  CHECK(scene::set_value(document, "/cloths/0/material/structural=1e-30"));
}
