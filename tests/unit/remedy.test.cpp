// The remedies that are offered after a blow-up.
#include "server/model/remedy.h"

#include "server/model/stability.h"
#include "tests/scenes.h"

using namespace clothlab;
using scene::Method;

TEST_CASE("a number is rounded down to two digits, at any size") {
  CHECK(model::rounded_down(0.00136) == 0.0013);
  CHECK(model::rounded_down(0.0013) == 0.0013);
  CHECK(model::rounded_down(1.0) == 1.0);
  CHECK(model::rounded_down(9.99e-7) == Approx(9.9e-7));
  CHECK(model::rounded_down(123.0) == 120.0);
}

TEST_CASE(
    "beyond the limit the remedy is four fifths of it, below it, where no shorter step is sure to hold, "
    "implicit Euler") {
  scene::Scene seed = test::seed();
  const model::Model cloth = *model::build(seed);
  for (const Method method : {Method::symplectic_euler, Method::verlet, Method::rk4}) {
    seed.solver.method = method;
    const double limit = model::dt_limit(cloth, seed);
    for (const double share : {0.91, 1.0, 1.5, 7.0}) {
      seed.solver.dt = share * limit;
      const model::Remedy remedy = model::remedy(cloth, seed, limit);
      CHECK_FALSE(remedy.method);
      CHECK(remedy.dt <= 0.8 * limit);
      CHECK(remedy.dt > 0.7 * limit);
    }
    for (const double share : {0.05, 0.5, 0.89}) {
      seed.solver.dt = share * limit;
      const model::Remedy remedy = model::remedy(cloth, seed, limit);
      CHECK(remedy.method == Method::implicit_euler);
      CHECK(remedy.dt == seed.solver.dt);
    }
  }
}

TEST_CASE("where the step would have to be a tenth or less, the remedy is a method without a limit") {
  scene::Scene seed = test::seed();
  const model::Model cloth = *model::build(seed);
  for (const double share : {9.0, 1e6}) {
    const double limit = model::dt_limit(cloth, seed);
    seed.solver.dt = share * limit;
    const model::Remedy remedy = model::remedy(cloth, seed, limit);
    CHECK(remedy.method == Method::implicit_euler);
    CHECK(remedy.dt <= 0.016);
    CHECK(remedy.text.find("implicit_euler") != std::string::npos);
  }
}

TEST_CASE("for explicit Euler the remedy is symplectic Euler, at a step that holds") {
  scene::Scene seed = test::seed();
  const model::Model cloth = *model::build(seed);
  seed.solver.method = Method::explicit_euler;
  for (const double dt : {1e-5, 0.001, 0.1}) {
    seed.solver.dt = dt;
    const model::Remedy remedy = model::remedy(cloth, seed, model::dt_limit(cloth, seed));
    REQUIRE(remedy.method == Method::symplectic_euler);
    scene::Scene healed = seed;
    healed.solver.method = *remedy.method;
    CHECK(remedy.dt <= dt);
    CHECK(remedy.dt < model::margin_to_warn * model::dt_limit(cloth, healed));
  }
}

TEST_CASE("a solver that holds stays as it is, one a little beyond its limit gets a shorter step") {
  scene::Scene seed = test::seed();
  const model::Model cloth = *model::build(seed);
  CHECK(model::solver_that_holds(cloth, seed) == seed.solver);
  const double limit = model::dt_limit(cloth, seed);
  for (const double share : {0.91, 1.5}) {
    seed.solver.dt = share * limit;
    const scene::Solver solver = model::solver_that_holds(cloth, seed);
    CHECK(solver.method == seed.solver.method);
    CHECK(solver.dt < model::margin_to_warn * limit);
    CHECK(solver.dt > 0.7 * limit);
  }
  seed.solver.dt = 7.0 * limit;
  CHECK(model::solver_that_holds(cloth, seed).method == Method::implicit_euler);
  for (const Method method : {Method::implicit_euler, Method::xpbd}) {
    seed.solver.method = method;
    CHECK(model::solver_that_holds(cloth, seed) == seed.solver);
  }
}

TEST_CASE("implicit Euler, which has no limit, gets half its step, and what sweeps gets implicit Euler") {
  scene::Scene seed = test::seed();
  seed.solver.method = Method::implicit_euler;
  seed.solver.dt = 0.02;
  CHECK(model::remedy(*model::build(seed), seed, model::no_limit).dt == Approx(0.01));
  for (const Method method : {Method::pbd, Method::xpbd, Method::vbd}) {
    seed.solver.method = method;
    CHECK(model::remedy(*model::build(seed), seed, model::no_limit).method == Method::implicit_euler);
  }
}
