// The factors on a spring's stretch in PBD and XPBD: their limits, and the motion of a single spring under
// them.
#include "server/model/constraint_gains.h"

#include <cmath>

#include "server/scene/method.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr double rounding = 0x1p-52;
constexpr double w = 3.0;  // [1/kg], sum of both ends

scene::Solver solver(Method method, int iterations, double dt = 0.02) {
  return {.method = method, .dt = dt, .iterations = iterations};
}

/// Length [m] after `visits` visits of a spring of 1 m that the step's free motion draws out to 1.5 m.
double visited(const scene::Solver& solver, double stiffness, double damping, int visits) {
  const elements::ConstraintGains gains = model::constraint_gains(solver, stiffness, damping, w);
  double length = 1.5, moved = 0.3;
  glm::dvec3 pushed(0.0);
  for (int n = 0; n < visits; ++n) {
    const glm::dvec3 push =
        elements::element_projection(elements::Spring{1.0, 0.0, 0.0}, gains, {{{0.0, length, 0.0}}},
                                     {{{0.0, moved, 0.0}}}, {{pushed}})
            .d[0];
    CHECK(std::abs(push.x) + std::abs(push.z) <= rounding);
    if (solver.method == Method::xpbd) pushed += push;
    length += w * push.y;
    moved += w * push.y;
  }
  return length;
}

}  // namespace

TEST_CASE("a spring without limit of stiffness has a gain of 1 / w: one visit brings it to its rest length") {
  for (const Method method : {Method::pbd, Method::xpbd}) {
    for (const double k : {1e8, 1e16, 1e300}) {
      const elements::ConstraintGains gains = model::constraint_gains(solver(method, 1), k, 0.0, w);
      INFO(scene::name(method) << ", " << k << " N/m");
      // 1 / (1 + 1 / (w k dt^2)) of it, and rounding.
      CHECK(std::abs(gains.stretch * w - 1.0) < 1.0 / (w * k * 4e-4) + 4 * rounding);
      CHECK(gains.memory < 1.0 / (w * k * 4e-4) + rounding);
    }
  }
}

TEST_CASE("the gains of a soft spring keep their digits: dt^2 k and dt c, whatever the iterations") {
  const double k = 1e-12, c = 1e-14, dt = 0.02;
  const elements::ConstraintGains xpbd = model::constraint_gains(solver(Method::xpbd, 10), k, c, w);
  const elements::ConstraintGains pbd = model::constraint_gains(solver(Method::pbd, 10), k, c, w);
  CHECK(xpbd.stretch == Approx(k * dt * dt).epsilon(1e-13));
  CHECK(xpbd.damping == Approx(c * dt).epsilon(1e-13));
  CHECK(pbd.stretch == Approx(k * dt * dt / 10).epsilon(1e-13));
  CHECK(pbd.damping == Approx(c * dt / 10).epsilon(1e-13));
  // Between two pinned vertices nothing moves, whatever the gains: these need only be finite.
  CHECK(model::constraint_gains(solver(Method::pbd, 10), 1e4, 1.0, 0.0).stretch == 1e4 * dt * dt);
}

TEST_CASE("with one iteration PBD is XPBD, which has pushed nothing yet") {
  for (const double k : {1e-3, 1.0, 1e3, 1e9}) {
    const elements::ConstraintGains pbd = model::constraint_gains(solver(Method::pbd, 1), k, 0.1, w);
    const elements::ConstraintGains xpbd = model::constraint_gains(solver(Method::xpbd, 1), k, 0.1, w);
    CHECK(pbd.stretch == Approx(xpbd.stretch).epsilon(8 * rounding));
    CHECK(pbd.damping == Approx(xpbd.damping).epsilon(8 * rounding));
    CHECK(pbd.memory == 0.0);
  }
}

TEST_CASE("a spring alone is after n visits of PBD where one visit of XPBD puts it: backward Euler's place") {
  for (const double k : {0.1, 100.0, 1e4, 1e9}) {
    for (const double c : {0.0, 2.0}) {
      const double dt = 0.02, coupling = w * (k * dt * dt + c * dt);
      // Backward Euler leaves 1 / (1 + coupling) of the force after the free motion.
      const double force = k * dt * dt * 0.5 + c * dt * 0.3;
      const double expected = 1.5 - w * force / (1.0 + coupling);
      for (const int visits : {1, 2, 7, 100}) {
        INFO(k << " N/m, " << c << " N s/m, " << visits << " visits");
        CHECK(std::abs(visited(solver(Method::xpbd, visits), k, c, 1) - expected) < 8 * rounding);
        // Further visits find nothing left to do.
        CHECK(std::abs(visited(solver(Method::xpbd, visits), k, c, visits) - expected) <
              8 * visits * rounding);
        CHECK(std::abs(visited(solver(Method::pbd, visits), k, c, visits) - expected) <
              8 * visits * rounding);
      }
    }
  }
}

TEST_CASE("a spring without length has no direction: neither PBD nor XPBD pushes it") {
  CHECK(elements::element_projection(elements::Spring{1.0, 0.0, 0.0}, {0.3, 0.1, 0.5, 2.0}, {glm::dvec3(0.0)},
                                     {glm::dvec3(0.1)}, {glm::dvec3(0.2)})
            .d[0] == glm::dvec3(0.0));
}
