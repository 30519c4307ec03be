// Implicit Euler on the GPU against the double-precision reference: after each Newton step, and at rest.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/reference/rest_shape.h"
#include "server/reference/trajectory.h"
#include "server/reference/vectors.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

TEST_CASE(
    "each step of implicit Euler and of BDF2 with one and with two Newton steps is the reference's with as "
    "many, pins moving") {
  const auto context = test::context();
  for (const Method method : {Method::implicit_euler, Method::bdf2})
    for (const int iterations : {1, 2}) {
      scene::Scene scene = swinging_cloth(method, 0.005);
      scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.1036};
      scene.cloths[0].material = scene::Fem{};  // cotton, whose vibrations such a step damps
      scene.cloths[0].pins[0].motion = scene::Oscillate{{0.0, 0.0, 1.0}, 0.02, 1.0};
      scene.air_drag = 0.5;
      scene.solver.iterations = iterations;
      scene.solver.tolerance = 1e-7;
      Stepped gpu(Side::gpu, scene);
      double worst = 0.0, moved = 0.0, apart = 0.0;
      reference::State last;
      for (int n = 0; n < 40; ++n) {
        reference::State before = gpu.state();
        before.contacts.assign(before.position.size(), 0);
        before.step = static_cast<std::uint64_t>(n);
        if (method == Method::bdf2 && n > 0) {
          before.way = reference::plus(before.position, -1.0, last.position);
          before.gain = reference::plus(before.velocity, -1.0, last.velocity);
        }
        last = before;
        reference::State expected = before, exact = before;
        reference::limited_newton_step(gpu.world(), expected);
        if (n == 39) reference::step(gpu.world(), exact);
        gpu.step(1);
        const reference::State found = gpu.state();
        worst = std::max(worst, reference::rms_distance(found.position, expected.position));
        moved = reference::rms_distance(found.position, before.position);
        if (n == 39) apart = reference::rms_distance(expected.position, exact.position);
      }
      // Places of 1 m are rounded to 3e-8 m. Stiff elements, some 12 at a vertex, move it by as much again
      // each.
      const double rounding = 12 * 0.5 * 0x1p-24;
      INFO(scene::name(method) << ", " << iterations << " Newton steps: off by " << worst
                               << " m, of a step of " << moved << " m; from the exact step " << apart
                               << " m");
      CHECK(worst < rounding);
      CHECK(apart > 2 * rounding);  // this number of Newton steps differs visibly from more
      CHECK(moved > 1e-3);
    }
}

TEST_CASE(
    "implicit Euler in steps of 0.05 s comes to rest with the energy of the balance that the reference "
    "finds") {
  const auto context = test::context();
  scene::Scene scene = swinging_cloth(Method::implicit_euler, 0.05);
  scene.cloths[0].mesh = scene::Grid{9, 9, 0.5, 0.5};
  scene.cloths[0].pins[1].at = scene::AtCorner{8, 0};
  Stepped gpu(Side::gpu, scene);
  const auto balance = reference::rest_shape(gpu.world());
  REQUIRE(balance);
  const std::vector<glm::dvec3> still(balance->position.size(), glm::dvec3(0.0));
  const reference::Energy expected = reference::energy(gpu.world(), {balance->position, still, {}});
  const double start = gpu.energy().total();
  gpu.step(300);
  const reference::Energy found = gpu.energy();
  // Its folds may have fallen the other way: the same energy, another shape. The energy has its minimum
  // there, so the solver's tolerance of 1e-4 shows only by its square.
  INFO("energy " << found.total() << " J, at balance " << expected.total() << " J, at the start " << start
                 << " J");
  CHECK(std::abs(found.total() - expected.total()) < 1e-5 * (start - expected.total()));
  CHECK(found.kinetic < 1e-6 * (start - expected.total()));
  CHECK(found.elastic == Approx(expected.elastic).epsilon(1e-3));
}
