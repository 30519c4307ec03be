// The energy of contact in double precision: force and stiffness against its differences, friction against
// its potential, and the share of a way that keeps a pair apart against the pair along that way.
#include <algorithm>
#include <cmath>
#include <random>

#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using elements::Corners;
using glm::dvec3;

TEST_CASE(
    "contact's force and stiffness are the derivatives of its energy, and go on where its stages meet") {
  constexpr double r = 0.003, k = 30.0, step = 1e-8;
  for (const double d : {0.0001, 0.0007, 0.00149, 0.0016, 0.0025, 0.00299, 0.0031}) {
    INFO(d << " m");
    const double force =
        (elements::contact_energy(d - step, r, k) - elements::contact_energy(d + step, r, k)) / (2.0 * step);
    const double stiffness =
        (elements::contact_force(d - step, r, k) - elements::contact_force(d + step, r, k)) / (2.0 * step);
    // Central differences leave a part (step / d)^2 of the value, and rounding 1e-16 / step of energies of
    // 1e-4 J.
    CHECK(elements::contact_force(d, r, k) == Approx(force).epsilon(1e-6).margin(1e-11));
    CHECK(elements::contact_stiffness(d, r, k) == Approx(stiffness).epsilon(1e-6).margin(1e-5));
  }
  for (const double where : {0.5 * r, r}) {
    CHECK(elements::contact_energy(where - 1e-15, r, k) ==
          Approx(elements::contact_energy(where + 1e-15, r, k)).margin(1e-15));
    CHECK(elements::contact_force(where - 1e-15, r, k) ==
          Approx(elements::contact_force(where + 1e-15, r, k)).margin(1e-12));
  }
  CHECK(elements::contact_energy(r, r, k) == 0.0);
  CHECK(elements::contact_energy(1e-12, r, k) > elements::contact_energy(1e-9, r, k));
}

TEST_CASE(
    "friction's force is the derivative of its potential, and all of it from the way on that counts as "
    "sliding") {
  constexpr double still = 1e-5, step = 1e-10;
  for (const double slid : {1e-7, 3e-6, 9.9e-6, 2e-5, 1e-3}) {
    INFO(slid << " m");
    const double force =
        (elements::friction_energy(slid + step, still) - elements::friction_energy(slid - step, still)) /
        (2.0 * step);
    CHECK(elements::friction_stiffness(slid, still) * slid == Approx(force).epsilon(1e-5));
  }
  CHECK(elements::friction_stiffness(2.0 * still, still) * 2.0 * still == Approx(1.0));
}

TEST_CASE("along the share of its way that it may take, a pair stays as far apart as it is to") {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  int cut = 0, near = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const bool edges = trial % 2 == 0;
    Corners c, way;
    for (int k = 0; k < 4; ++k) {
      c.x[k] = {either(random), 0.2 * either(random), either(random)};
      way.x[k] = dvec3(either(random), either(random), either(random));
    }
    const double gap = elements::separation(edges, c).gap, keep = 0.1 * gap;
    if (gap < 1e-3) continue;
    const double share = elements::share_apart(edges, c, way, keep);
    REQUIRE((share >= 0.0 && share <= 1.0));
    double least = gap;
    const auto gap_at = [&](double at) {
      Corners there;
      for (int k = 0; k < 4; ++k) there.x[k] = c.x[k] + at * way.x[k];
      return elements::separation(edges, there).gap;
    };
    for (int look = 0; look <= 50; ++look) least = std::min(least, gap_at(share * look / 50.0));
    CHECK(least >= keep - 1e-12);
    if (share == 1.0) continue;
    ++cut;
    // A bound that is far too small would hold the cloth: half of the cut ways end within twice what is to be
    // kept.
    near += gap_at(share) < 2.0 * keep;
  }
  CHECK(cut > 300);
  CHECK(2 * near > cut);
}
