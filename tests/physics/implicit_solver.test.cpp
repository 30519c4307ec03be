// Iterations of implicit Euler's linear solver: what its preconditioner and its first guess spare.
#include <cmath>

#include "server/scene/document.h"
#include "tests/scenes.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

TEST_CASE(
    "implicit Euler: news of a pull passes along a stiff chain in fewer iterations than it has vertices") {
  const auto context = test::context();
  // The matrix couples neighbours alone, so block Jacobi takes news one vertex further an iteration. In this
  // chain a pull reaches sqrt(k dt^2 / m) = 200 vertices far, so that the end of 200 must know of the pin:
  // the guess is wrong there by the whole speed of a free fall.
  const int links = 200;
  scene::Scene scene = chain(Method::implicit_euler, 0.1, links, 4e6, 1.0);
  scene.gravity = {0.0, 0.0, 9.81};
  scene.solver.iterations = 1;
  const auto one = simulation(scene);
  one->step(1);
  const sim::SolverWork work = one->solver_work();
  INFO(work.linear_iterations << " iterations");
  CHECK(work.unconverged == 0);
  CHECK(work.linear_iterations < links / 2);
  const sim::State state = one->read_state();
  CHECK(state.velocity.back().z < 0.5 * 9.81 * 0.1);  // of the guess, a free fall: the end knows of the pin
}

TEST_CASE("implicit Euler: patches of stiff cloth that turn and shear spare iterations") {
  const auto context = test::context();
  // Cotton is 10,000 times as stiff along itself as across, so that patches that only shift cannot turn with
  // it. With 31 such patches this sheet takes 84 iterations a step, with 15 of these 53.
  scene::Scene scene;
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{25, 25, 1.0, 1.0};
  cloth.mass = {scene::Mass::Kind::area_density, 0.1036};
  cloth.material = scene::Fem{};
  for (const int column : {0, 24}) cloth.pins.push_back({scene::AtCorner{column, 0}, {}});
  scene.solver = {.method = Method::implicit_euler, .dt = 1.0 / 60, .iterations = 1};
  const auto falling = simulation(scene);
  const int steps = 30;
  falling->step(steps);
  const sim::SolverWork work = falling->solver_work();
  INFO(work.linear_iterations << " iterations in " << steps << " steps");
  CHECK(work.unconverged == 0);
  CHECK(work.linear_iterations < 72 * steps);
}

TEST_CASE("implicit Euler: a smooth motion takes fewer iterations when the solver knows the last steps") {
  const auto context = test::context();
  scene::Scene scene = scene::load_preset("hanging-strip")->scene;
  scene.solver = {.method = Method::implicit_euler, .dt = 1.0 / 60, .iterations = 1};
  const auto iterations = [&](bool knows) {
    const auto swing = simulation(scene);
    for (int n = 0; n < 60; ++n) {
      swing->step(1);
      if (!knows) swing->forget_carried();
    }
    return swing->solver_work().linear_iterations;
  };
  const auto with = iterations(true), without = iterations(false);
  INFO(with << " iterations, " << without << " without the last steps");
  // Over a step of 1/60 s velocities of a swing of about a second continue as a parabola to some 1e-3 of
  // their change: about two of the four digits that the tolerance asks for are there before the first
  // iteration.
  CHECK(static_cast<double>(with) < 0.75 * static_cast<double>(without));
}
