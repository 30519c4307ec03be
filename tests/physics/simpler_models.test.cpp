// The lab's verdict on springs in place of finite elements, and on one stiffness for warp and weft.
#include <algorithm>
#include <cmath>

#include "tests/simplified.h"

using namespace clothlab;
using namespace clothlab::test;
using lab::Simplification;
using lab::Variant;

namespace {

/// A sheet of finite elements with a material of its own, hung by its first row, swinging under a weight.
scene::Document swinging_sheet(const std::string& material, const char* dt = "0.0004") {
  return document_of(
      R"({"version": 1, "name": "swinging", "gravity": [0, -4, 9],
    "cloths": [{"mesh": {"grid": {"columns": 9, "rows": 9, "width": 0.4, "height": 0.4}},
                "mass": {"area_density": 0.2}, "material": {"model": "fem", )" +
      material + R"(}, "pins": [{"at": "edge:row:0"}]}], "solver": {"method": "verlet", "dt": )" + dt + "}}");
}
/// What a simulated second costs: steps times elements, of which finite ones cost twice as much.
double cost_by_model(const scene::Scene& scene) {
  const auto& grid = std::get<scene::Grid>(scene.cloths[0].mesh);
  const bool fem = std::holds_alternative<scene::Fem>(scene.cloths[0].material);
  return grid.columns * grid.rows / scene.solver.dt * (fem ? 2.0 : 1.0);
}

}  // namespace

TEST_CASE("a sheet that is alike along warp and weft and hangs stiff needs no more than springs") {
  const auto context = test::context();
  // A sheet with the ratio that springs have: with structural = shear = k, poisson = 1/2 and Y = 3/2 k.
  const scene::Document whole = swinging_sheet(
      R"("warp": 90, "weft": 90, "poisson": 0.5, "shear": 60, "bending": 1e-5, "damping": 0.0005)");
  lab::SimplifyRequest request{2e-2, 0.2};
  request.timer = cost_by_model;
  const Simplification result = simplified(whole, request);
  REQUIRE(result.whole.measured);
  const Variant& springs = variant(result, "with springs instead of finite elements");
  REQUIRE(springs.measured);
  INFO("springs change " << *springs.change << "\n" << result.why);
  CHECK(*springs.change > 1e-6);  // it is another model
  CHECK(*springs.change < 2e-2);
  CHECK(*springs.error[lab::index(lab::Axis::position)] < 2e-2);
  CHECK(springs.recommended_to_drop);
  CHECK(result.why.find("Springs suffice here: ") == 0);
  CHECK(result.why.find(" of the size (2 % allowed), ") != std::string::npos);
  CHECK(springs.patch["cloths"][0]["material"]["model"] == "springs");
  const auto patched = scene::apply_patch(whole, springs.patch);
  REQUIRE(patched);
  CHECK(std::holds_alternative<scene::Springs>(patched->scene.cloths[0].material));
  // Its step is the same share of its own limit.
  const double dt = patched->scene.solver.dt;
  CHECK(dt / springs.dt_limit == Approx(0.0004 / result.whole.dt_limit).epsilon(1e-6));
  const Variant& isotropic = variant(result, "with warp and weft alike");
  CHECK_FALSE(isotropic.measured);
  CHECK(isotropic.reason == "the scene has no cloth of finite elements whose warp and weft differ");
}

TEST_CASE("springs are fitted to a sheet of triangles, too, and suffice where it is isotropic") {
  const auto context = test::context();
  // Springs on triangles act as an isotropic sheet that contracts by a third of its stretch.
  nlohmann::json value =
      swinging_sheet(
          R"("warp": 90, "weft": 90, "poisson": 0.3333, "shear": 33.75, "bending": 1e-5, "damping": 0.0005)")
          .value;
  nlohmann::json& cloth = value["cloths"][0];
  cloth["mesh"] = {{"vertices", nlohmann::json::array()}, {"triangles", nlohmann::json::array()}};
  cloth["pins"] = nlohmann::json::array();
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 9; ++column) {
      cloth["mesh"]["vertices"].push_back({0.05 * column, 0.0, 0.05 * row});
      const int a = 9 * row + column, b = a + 1, c = a + 10, d = a + 9;
      if (row == 0) cloth["pins"].push_back({{"at", "vertex:" + std::to_string(a)}});
      if (row == 8 || column == 8) continue;
      const bool turned = (row + column) % 2 == 1;
      cloth["mesh"]["triangles"].push_back({a, b, turned ? d : c});
      cloth["mesh"]["triangles"].push_back({turned ? b : a, c, d});
    }
  const scene::Document whole = document_of(value.dump());
  lab::SimplifyRequest request{2e-2, 0.2};
  request.timer = [](const scene::Scene& scene) {
    return (std::holds_alternative<scene::Fem>(scene.cloths[0].material) ? 2.0 : 1.0) / scene.solver.dt;
  };
  const Simplification result = simplified(whole, request);
  REQUIRE(result.whole.measured);
  const Variant& springs = variant(result, "with springs instead of finite elements");
  INFO((springs.measured ? result.why : springs.reason));
  REQUIRE(springs.measured);
  CHECK(*springs.change > 1e-6);
  CHECK(*springs.change < 2e-2);
  CHECK(result.why.find("Springs suffice here: ") == 0);
}

TEST_CASE(
    "where warp and weft differ much and the grain is oblique, neither springs nor one stiffness suffices") {
  const auto context = test::context();
  const scene::Document whole = swinging_sheet(
      R"("warp": 30, "weft": 300, "poisson": 0, "shear": 3, "bending": 1e-5, "damping": 0.0005, "grain": 30)",
      "0.0001");
  lab::SimplifyRequest request{1e-3, 0.25};
  request.timer = cost_by_model;
  const Simplification result = simplified(whole, request);
  REQUIRE(result.whole.measured);
  for (const char* name : {"with springs instead of finite elements", "with warp and weft alike"}) {
    const Variant& model = variant(result, name);
    INFO(name << (model.measured ? "" : model.reason));
    REQUIRE(model.change);
    CHECK(*model.change > 1e-3);
    CHECK_FALSE(model.recommended_to_drop);
  }
  CHECK(result.why.find("Isotropic does not suffice here: ") == 0);
  CHECK(result.why.find("\nSprings do not suffice here: ") != std::string::npos);
}

TEST_CASE("of two simpler models of a cloth one is recommended, and it is fitted to what is left") {
  const auto context = test::context();
  const scene::Document whole = swinging_sheet(
      R"("warp": 90, "weft": 91, "poisson": 0.5, "shear": 60, "bending": 1e-5, "damping": 0.0005)");
  lab::SimplifyRequest request{0.2, 0.2};
  // One stiffness for both saves, too, so that it would be taken in addition.
  request.timer = [](const scene::Scene& scene) {
    const auto* sheet = std::get_if<scene::Fem>(&scene.cloths[0].material);
    return cost_by_model(scene) * (sheet && sheet->warp == sheet->weft ? 0.5 : 1.0);
  };
  const Simplification result = simplified(whole, request);
  REQUIRE(result.recommended.recommended_to_drop);
  INFO(result.recommended.name);
  const bool springs = result.recommended.name.find("springs instead") != std::string::npos,
             alike = result.recommended.name.find("alike") != std::string::npos;
  CHECK(springs != alike);
  // The other one is not even tried in addition.
  CHECK(std::none_of(result.notes.begin(), result.notes.end(), [](const std::string& note) {
    return note.find("springs instead") != std::string::npos && note.find("alike") != std::string::npos;
  }));
  const auto patched = scene::apply_patch(whole, result.recommended.patch);
  REQUIRE(patched);
  CHECK(std::get<scene::Grid>(patched->scene.cloths[0].mesh).columns < 9);
}
