// The stiffness that is reported for PBD, which has none in N/m.
#include <cmath>

#include "server/model/constraint_gains.h"
#include "tests/scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

scene::Scene undamped(int iterations) {
  scene::Scene scene = test::seed();
  scene.solver = {Method::pbd, 0.002, iterations, 1e-4};
  scene.cloths[0].springs().damping = 0.0;
  return scene;
}

}  // namespace

TEST_CASE("PBD's shares, one after another, leave of a stretch what implicit Euler would leave") {
  for (const int iterations : {1, 10, 1000}) {
    const scene::Scene scene = undamped(iterations);
    const auto shares = model::pbd_stiffness(*model::build(scene), scene);
    REQUIRE(shares.size() == 1);
    const double k[] = {scene.cloths[0].springs().structural, scene.cloths[0].springs().shear,
                        scene.cloths[0].springs().bend};
    for (int kind = 0; kind < 3; ++kind) {
      REQUIRE(shares[0][kind]);
      // Both ends of a spring between free vertices of 0.1 kg move: 2 / m.
      const double left = 1.0 / (1.0 + 2.0 / 0.1 * k[kind] * 0.002 * 0.002);
      CHECK(std::pow(1.0 - *shares[0][kind], iterations) == Approx(left).epsilon(1e-9));
    }
  }
}

TEST_CASE("PBD's share is told for each cloth by its own mass, and only for springs that are there") {
  scene::Scene scene = undamped(1);
  scene.cloths[0].springs().bend = 0.0;
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "lighter";
  // An inner vertex has the mass of a cell of 1/24 m; those on the border have less.
  scene.cloths[1].mass = {scene::Mass::Kind::area_density, 0.05 * 24 * 24};
  const auto shares = model::pbd_stiffness(*model::build(scene), scene);
  REQUIRE(shares.size() == 2);
  for (const model::PbdStiffness& cloth : shares) CHECK_FALSE(cloth[2]);
  const double k = scene.cloths[0].springs().structural * 0.002 * 0.002;
  CHECK(*shares[0][0] == Approx(1.0 - 1.0 / (1.0 + 20.0 * k)));
  CHECK(*shares[1][0] == Approx(1.0 - 1.0 / (1.0 + 40.0 * k)));
}
