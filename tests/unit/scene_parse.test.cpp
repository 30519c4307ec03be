// Untrusted text: the answer is always a value, or an error that says where.
#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::json;
using scene::parse_json;

namespace {

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

}  // namespace

TEST_CASE("JSON parses to the value that nlohmann_json gives") {
  const std::string text =
      R"( {"a": [1, -2, 3.5, 1e-4, true, false, null, "\u00e9\"/"], "b": {"c": {}, "d": []}} )";
  const Result<json> value = parse_json(text, "test");
  REQUIRE(value);
  CHECK(*value == json::parse(text));
  CHECK(value->dump() == json::parse(text).dump());
  for (const char* plain : {"7", "null", "\"x\"", "-0.5"})
    CHECK(*parse_json(plain, "test") == json::parse(plain));
}

TEST_CASE("32 levels of nesting parse and 33 do not, nor do a million") {
  CHECK(parse_json(nested(32), "test"));
  const Error error = parse_json(nested(33), "test").error();
  CHECK(error.where == "test, line 1, column 33");
  CHECK_FALSE(parse_json(std::string(1000000, '['), "test", false, {2000000}));
  std::string objects;
  for (int i = 0; i < 33; ++i) objects += "{\"a\":";
  CHECK(parse_json(objects, "test").error().what == "more than 32 levels of nesting");
  CHECK(parse_json(nested(9), "test", false, {scene::max_json_bytes, 8}).error().remedy == "at most 8");
  CHECK(parse_json(nested(8), "test", false, {scene::max_json_bytes, 8}));
}

TEST_CASE("a text of just the allowed size parses and one byte more does not") {
  CHECK(parse_json("\"" + std::string(scene::max_json_bytes - 2, 'x') + "\"", "test"));
  CHECK_FALSE(parse_json("\"" + std::string(scene::max_json_bytes - 1, 'x') + "\"", "test"));
}

TEST_CASE("broken JSON is refused with its line and column") {
  CHECK(parse_json("{\n  \"a\": 1,\n  oops\n}", "test").error().where == "test, line 3, column 3");
  CHECK(parse_json("", "test").error().where == "test, line 1, column 1");
  CHECK(parse_json("[1,]", "test").error().where == "test, line 1, column 4");
  CHECK_FALSE(parse_json("[1] [2]", "test"));
  CHECK_FALSE(parse_json("\"\xff\"", "test"));
  CHECK_FALSE(parse_json("[NaN]", "test"));
  CHECK_FALSE(parse_json("[Infinity]", "test"));
}

TEST_CASE("a number too large for a double is refused, one too small reads as 0") {
  CHECK(parse_json("[1e999]", "test").error().what.find("1e999") != std::string::npos);
  CHECK_FALSE(parse_json("-1e999", "test"));
  CHECK(parse_json("1e-999", "test")->get<double>() == 0.0);
  CHECK(parse_json("123456789012345678901234567890", "test")->is_number_float());
}

TEST_CASE("a repeated key is refused at its second place") {
  const Error error = parse_json("{\"dt\": 1,\n \"dt\": 2}", "test").error();
  CHECK(error.what == "the key \"dt\" a second time");
  CHECK(error.where == "test, line 2, column 5");
  CHECK(parse_json(R"([{"a": 1}, {"a": {"a": 2}}])", "test"));
}

TEST_CASE("comments are allowed only where they are asked for") {
  const std::string text = "{ // why\n \"a\": 1 /* and */ }";
  CHECK(parse_json(text, "test", true));
  CHECK_FALSE(parse_json(text, "test"));
}
