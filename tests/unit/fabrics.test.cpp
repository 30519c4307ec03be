// Fabrics by name: the file, what a scene makes of a name, and what a change of it does.
#include "server/scene/fabrics.h"

#include <map>

#include "server/model/model.h"
#include "server/scene/named_fabric.h"
#include "tests/scenes.h"

using namespace clothlab;
using scene::json;

namespace {

const std::vector<scene::Fabric>& all() {
  const auto& fabrics = scene::fabrics();
  if (!fabrics) FAIL(fabrics.error().text());
  return *fabrics;
}

const scene::Fabric& fabric(const std::string& name) {
  for (const scene::Fabric& each : all())
    if (each.name == name) return each;
  FAIL("no fabric " << name);
  return all().front();
}

json scene_with(json material) {
  return {{"version", 1},
          {"cloths", {{{"mesh", {{"grid", {{"columns", 11}, {"rows", 11}}}}}, {"material", material}}}}};
}

scene::Document valid(json value) {
  const auto document = scene::validate(std::move(value));
  if (!document) FAIL(document.error().text());
  return *document;
}

scene::Document patched(const scene::Document& document, json patch) {
  const auto after = scene::apply_patch(document, patch);
  if (!after) FAIL(after.error().text());
  return *after;
}

json replace(const std::string& key, json value) {
  return json::array({{{"op", "replace"}, {"path", "/cloths/0/" + key}, {"value", std::move(value)}}});
}

const scene::Cloth& cloth(const scene::Document& document) {
  return document.scene.cloths[0];
}

scene::Fem sheet(const scene::Document& document) {
  return std::get<scene::Fem>(cloth(document).material);
}

}  // namespace

TEST_CASE("every fabric has a name of one word, says what it is like and where its numbers are from") {
  std::map<std::string, int> names;
  for (const scene::Fabric& each : all()) {
    INFO(each.name);
    CHECK(each.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz") == std::string::npos);
    CHECK(++names[each.name] == 1);
    CHECK(each.feel.size() > 20);
    CHECK(each.feel.size() < 90);                      // one line of the menu
    CHECK_THAT(each.source, ContainsSubstring("20"));  // a year
    CHECK(each.sheet.grain == 0.0);
    CHECK_FALSE(each.sheet.strain_limit);
  }
  for (const char* name : {"cotton", "silk", "denim", "canvas", "wool", "polyester", "interlock", "rib",
                           "ponte", "swimsuit", "ribbon", "tango"})
    CHECK(names.count(name) == 1);
}

TEST_CASE("a knit that is bent along the diagonal resists as it was measured at 45 degrees") {
  // Curvature k along the diagonal is k/2 along warp, along weft and of twist; the energy is half of
  // warp k_w^2 + weft k_f^2 + 4 twist k_wf^2.
  const std::map<std::string, double> measured = {{"interlock", 25e-6}, {"rib", 30e-6},    {"ponte", 33e-6},
                                                  {"swimsuit", 59e-6},  {"ribbon", 88e-6}, {"tango", 22e-6}};
  for (const auto& [name, at_45] : measured) {
    INFO(name);
    const auto& [warp, weft, twist] = fabric(name).sheet.bending;
    REQUIRE(twist);
    CHECK((warp + weft) / 4 + *twist == Approx(at_45).epsilon(1e-12));
    CHECK(*twist >= 0.0);
  }
}

TEST_CASE("a fabric alone is a sheet with its numbers and its weight") {
  for (const scene::Fabric& each : all()) {
    INFO(each.name);
    const scene::Document document = valid(scene_with({{"fabric", each.name}}));
    CHECK(sheet(document) == each.sheet);
    CHECK(cloth(document).mass == scene::Mass{scene::Mass::Kind::area_density, each.area_density});
    CHECK(model::build(document.scene));
  }
}

TEST_CASE("numbers beside the name are the cloth's own") {
  json value = scene_with({{"model", "fem"}, {"fabric", "cotton"}, {"shear", 200}, {"grain", 45}});
  value["cloths"][0]["mass"] = {{"per_vertex", 0.01}};
  const scene::Document document = valid(value);
  scene::Fem expected = fabric("cotton").sheet;
  expected.shear = 200;
  expected.grain = 45;
  CHECK(sheet(document) == expected);
  CHECK(cloth(document).mass == scene::Mass{scene::Mass::Kind::per_vertex, 0.01});
}

TEST_CASE("an unknown fabric is refused with its place, the name and the nearest of those there are") {
  const auto document = scene::validate(scene_with({{"fabric", "coton"}}));
  REQUIRE_FALSE(document);
  CHECK(document.error().where == "/cloths/0/material/fabric");
  CHECK(document.error().what == "\"coton\"");
  CHECK_THAT(document.error().remedy,
             ContainsSubstring("did you mean \"cotton\"?") && ContainsSubstring("\"interlock\""));
}

TEST_CASE("a Poisson's ratio that a fabric's does not fit an own modulus is refused at its place") {
  // Silk has 0.5, and 0.25 is above 100 / 755.
  const auto document = scene::validate(scene_with({{"fabric", "silk"}, {"warp", 100}}));
  REQUIRE_FALSE(document);
  CHECK(document.error().where == "/cloths/0/material/poisson");
  CHECK_THAT(document.error().what, ContainsSubstring("0.5, the fabric's"));
}

TEST_CASE("another name changes every number that the document does not have, and no other") {
  const scene::Document cotton = valid(scene_with({{"fabric", "cotton"}, {"shear", 200}}));
  const scene::Document silk = patched(cotton, replace("material/fabric", "silk"));
  scene::Fem expected = fabric("silk").sheet;
  expected.shear = 200;
  CHECK(sheet(silk) == expected);
  CHECK(cloth(silk).mass.value == fabric("silk").area_density);
  // There and back again is the same document; without its key, the number is the fabric's again.
  CHECK(patched(silk, replace("material/fabric", "cotton")) == cotton);
  const json remove = json::array({{{"op", "remove"}, {"path", "/cloths/0/material/shear"}}});
  CHECK(sheet(patched(silk, remove)) == fabric("silk").sheet);
}

TEST_CASE("the document keeps a fabric's name and not its numbers, also when it is saved and loaded") {
  const scene::Document document = valid(scene_with({{"fabric", "denim"}}));
  CHECK(document.value["cloths"][0]["material"] ==
        json{{"model", "fem"}, {"fabric", "denim"}, {"grain", 0.0}, {"strain_limit", nullptr}});
  CHECK_FALSE(document.value["cloths"][0].contains("mass"));
  CHECK(valid(document.value) == document);
}

TEST_CASE("what is left to the fabric can be looked up, and written out it is the same scene") {
  for (const char* model : {"fem", "springs"}) {
    INFO(model);
    const scene::Document document =
        valid(scene_with({{"model", model}, {"fabric", "interlock"}, {"damping", 0.25}}));
    const json left = scene::left_to_fabrics(document)[0];
    CHECK_FALSE(left["material"].contains("damping"));
    CHECK(left["mass"]["area_density"] == 0.187);
    const json whole = scene::spelled_out(document);
    json named_nothing = whole;
    named_nothing["cloths"][0]["material"].erase("fabric");
    CHECK(valid(named_nothing).scene == document.scene);
  }
  CHECK(scene::left_to_fabrics(valid(scene_with(json::object())))[0].is_null());
}

TEST_CASE("a fabric that is named later replaces the defaults that the program wrote, and nothing else") {
  const json add = json::array({{{"op", "add"}, {"path", "/cloths/0/material/fabric"}, {"value", "cotton"}}});
  const scene::Document plain = valid(scene_with(json::object()));
  CHECK(patched(plain, add).scene == valid(scene_with({{"model", "springs"}, {"fabric", "cotton"}})).scene);
  CHECK(scene::set_value(plain, "/cloths/0/material/fabric=cotton")->scene == patched(plain, add).scene);
  json own = scene_with({{"structural", 300}});
  own["cloths"][0]["mass"] = {{"per_vertex", 0.002}};
  const scene::Document named = patched(valid(own), add);
  CHECK(cloth(named).springs().structural == 300);
  CHECK(cloth(named).springs().shear == fabric("cotton").sheet.shear);
  CHECK(cloth(named).mass == scene::Mass{scene::Mass::Kind::per_vertex, 0.002});
  CHECK(sheet(patched(valid(scene_with({{"model", "fem"}})), add)) == fabric("cotton").sheet);
}
