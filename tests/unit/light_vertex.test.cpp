// The lightest vertex that float32 allows: its inverse mass times the largest stiffness is still finite.
#include <cmath>

#include "server/model/model.h"
#include "server/scene/document.h"
#include "server/scene/ranges.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

/// A triangle with legs of `side` [m] and 1 kg/m^2: each vertex gets a sixth of side^2 [kg].
Result<model::Model> triangle(double side) {
  scene::Scene scene;
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::TriangleMesh{{{0, 0, 0}, {0, 0, side}, {side, 0, 0}}, {{0, 1, 2}}};
  cloth.mass = {scene::Mass::Kind::area_density, 1.0};
  return model::build(scene);
}

}  // namespace

TEST_CASE("a vertex so light that its inverse mass is beyond float32 is refused at its cloth's mass") {
  for (const double side : {1e-100, 1e-25, 7e-8}) {
    const Result<model::Model> model = triangle(side);
    REQUIRE_FALSE(model);
    CHECK(model.error().where == "/cloths/0/mass");
    CHECK(model.error().what.rfind("vertex 0 would ", 0) == 0);
    CHECK(model.error().remedy.find("1e-15 kg") != std::string::npos);
  }
  const Result<model::Model> model = triangle(8e-8);
  REQUIRE(model);
  CHECK(std::isfinite(static_cast<float>(1.0 / model->mass[0]) *
                      static_cast<float>(scene::ranges::stiffness.maximum)));
}
