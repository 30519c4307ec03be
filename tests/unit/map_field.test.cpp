// The number that a stability map varies: how it is found, checked and spaced.
#include <cmath>

#include "server/lab/measure/map_field.h"
#include "tests/catch.h"

using namespace clothlab;
using lab::MapField;

namespace {

scene::Document seed() {
  return *scene::load_preset("seed");
}

Error refused(const std::string& field) {
  const Result<MapField> found = MapField::find(seed(), field);
  REQUIRE_FALSE(found);
  return found.error();
}

Error refused_range(const std::string& field, std::optional<double> from, std::optional<double> to,
                    int columns = 5) {
  const auto values = MapField::find(seed(), field)->values(from, to, columns);
  REQUIRE_FALSE(values);
  return values.error();
}

}  // namespace

TEST_CASE("a field that is no number of the scene is refused with what it is") {
  CHECK(refused("/cloths/0/mass/per_vortex").where == "field");
  CHECK(refused("cloths").where == "field");
  CHECK(refused("").where == "field");
  CHECK(refused("/cloths/0/name").what == "\"cloth\" at /cloths/0/name");
  CHECK(refused("/cloths/0/material/strain_limit").what.starts_with("null"));
  CHECK(refused("/solver/dt").remedy.find("other axis") != std::string::npos);
  CHECK_FALSE(MapField::find(
      *scene::apply_patch(seed(), {{"cloths", scene::json::array({seed().value["cloths"][0]})}}),
      "/cloths/1/mass/per_vertex"));
}

TEST_CASE("a range is refused where it is none, and where the scene does not allow it") {
  const std::string mass = "/cloths/0/mass/per_vertex";
  CHECK(refused_range(mass, 2.0, 1.0).where == "to");
  CHECK(refused_range(mass, 1.0, 1.0).where == "to");
  CHECK(refused_range(mass, 0.1, 1.0, 1).where == "columns");
  CHECK(refused_range(mass, 0.1, 1.0, 42).where == "columns");
  CHECK(refused_range(mass, -1.0, 1.0).where == mass);  // the validator's error
  CHECK(refused_range(mass, std::nan(""), 1.0).where == "from");
  CHECK(refused_range("/air_drag", std::nullopt, 1.0).remedy.find("present value is 0") != std::string::npos);
}

TEST_CASE("values are spaced in the logarithm above 0 and evenly from 0 or less") {
  const auto factor = *MapField::find(seed(), "stiffness")->values({}, {}, 5);
  REQUIRE(factor.size() == 5);
  for (int i = 0; i < 5; ++i) CHECK(factor[static_cast<std::size_t>(i)] == Approx(std::pow(10.0, i - 2)));
  const auto drag = *MapField::find(seed(), "/air_drag")->values(0.0, 8.0, 5);
  CHECK(drag == std::vector<double>{0, 2, 4, 6, 8});
  const auto gravity = *MapField::find(seed(), "/gravity/1")->values({}, {}, 3);
  CHECK(gravity == std::vector<double>{-19.6, -9.8, 0});
}

TEST_CASE(
    "where only whole numbers are allowed values are whole, each once, and within what the scene allows") {
  const MapField rows = *MapField::find(seed(), "/cloths/0/mesh/grid/rows");
  CHECK(*rows.values(20.0, 24.0, 9) == std::vector<double>{20, 21, 22, 23, 24});
  // The seed's pin at corner 24,0 needs 25 columns.
  const auto columns = *MapField::find(seed(), "/cloths/0/mesh/grid/columns")->values({}, {}, 3);
  CHECK(columns.front() == 25);
  CHECK(columns.back() == 100);
  double asked = 20.6;
  CHECK(std::get<scene::Grid>(rows.with(asked)->scene.cloths[0].mesh).rows == 21);
  CHECK(asked == 21);
}

TEST_CASE("a factor multiplies every stiffness of every cloth and nothing else") {
  double factor = 0.5;
  const scene::Scene before = seed().scene, after = MapField::find(seed(), "stiffness")->with(factor)->scene;
  scene::Scene expected = before;
  for (scene::Cloth& cloth : expected.cloths) {
    cloth.springs().structural *= 0.5;
    cloth.springs().shear *= 0.5;
    cloth.springs().bend *= 0.5;
  }
  CHECK(after == expected);
}

namespace {

scene::Document sheet() {
  return *scene::apply_patch(
      seed(), scene::json::array({{{"op", "replace"},
                                   {"path", "/cloths/0/material"},
                                   {"value",
                                    {{"model", "fem"},
                                     {"shear", 97},
                                     {"bending", {{"warp", 8e-6}, {"weft", 12e-6}, {"twist", 5e-6}}}}}}}));
}

}  // namespace

TEST_CASE(
    "a factor on the stiffness multiplies a sheet's moduli and bending, not its ratio nor its damping") {
  double factor = 0.5;
  const scene::Scene before = sheet().scene;
  const scene::Scene after = MapField::find(sheet(), "stiffness")->with(factor)->scene;
  scene::Scene expected = before;
  auto& fem = std::get<scene::Fem>(expected.cloths[0].material);
  fem.warp *= 0.5;
  fem.weft *= 0.5;
  fem.shear *= 0.5;
  fem.bending = {4e-6, 6e-6, 2.5e-6};
  CHECK(after == expected);
}

TEST_CASE("a field of a sheet's material has its own unit, where springs have another") {
  const auto unit = [](const std::string& key) {
    return MapField::find(sheet(), "/cloths/0/material/" + key)->unit();
  };
  CHECK(unit("warp") == "N/m");
  CHECK(unit("weft") == "N/m");
  CHECK(unit("shear") == "N/m");
  CHECK(unit("damping") == "s");
  CHECK(unit("poisson") == "");
  CHECK(unit("grain") == "degrees");
  CHECK(unit("bending/warp") == "N m");
  CHECK(unit("bending/weft") == "N m");
  CHECK(unit("bending/twist") == "N m");
  CHECK(MapField::find(seed(), "/cloths/0/material/damping")->unit() == "N s/m");
  CHECK(MapField::find(seed(), "/cloths/0/material/shear")->unit() == "N/m");
  CHECK(MapField::find(sheet(), "/cloths/0/mass/per_vertex")->unit() == "kg");
}

TEST_CASE("a field of a sheet varies as far as its ratio of moduli allows") {
  // poisson^2 < warp / weft, by default 0.311 of 2365 and 3801.
  const auto poisson = *MapField::find(sheet(), "/cloths/0/material/poisson")->values({}, {}, 3);
  CHECK(poisson.back() == Approx(std::sqrt(2365.0 / 3801.0)).epsilon(2e-3));
  const auto warp = *MapField::find(sheet(), "/cloths/0/material/warp")->values({}, {}, 3);
  CHECK(warp.front() == Approx(0.311 * 0.311 * 3801).epsilon(2e-3));
}

TEST_CASE("a field has its unit") {
  CHECK(MapField::find(seed(), "stiffness")->unit() == "times the present");
  CHECK(MapField::find(seed(), "/cloths/0/mass/per_vertex")->unit() == "kg");
  CHECK(MapField::find(seed(), "/gravity/1")->unit() == "m/s^2");
  CHECK(MapField::find(seed(), "/colliders/0/sphere/center/2")->unit() == "m");
  CHECK(MapField::find(seed(), "/solver/iterations")->unit() == "");
}

TEST_CASE("a number that a cloth leaves to its fabric can be the field, and other fields leave it there") {
  const scene::Document silk = *scene::set_value(
      *scene::set_value(seed(), R"(/cloths/0/material={"model": "springs", "fabric": "silk"})"),
      "/name=silk");
  const std::string shear = "/cloths/0/material/shear", columns = "/cloths/0/mesh/grid/columns";
  CHECK(*MapField::find(silk, shear)->values(51.0, 102.0, 2) == std::vector<double>{51, 102});
  double value = 102;
  CHECK(MapField::find(silk, shear)->with(value)->scene.cloths[0].springs().shear == 102);
  value = 49;
  const double bend = silk.scene.cloths[0].springs().bend;
  CHECK(MapField::find(silk, columns)->with(value)->scene.cloths[0].springs().bend > 1.5 * bend);
  value = 2;
  CHECK(MapField::find(silk, "stiffness")->with(value)->scene.cloths[0].springs().bend ==
        Approx(2 * bend).epsilon(1e-12));
}
