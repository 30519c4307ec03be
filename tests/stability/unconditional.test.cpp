// The two extremes: explicit Euler without damping is stable at no dt, implicit Euler and BDF2 at
// any.
#include <algorithm>
#include <cmath>

#include "server/model/stability.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// Energy of both copies of one_spring about its balance [J].
double spring_energy(const reference::State& state) {
  const double u = state.position[spring_end].z - spring_balance, v = state.velocity[spring_end].z;
  return v * v + spring_omega * spring_omega * u * u;
}

}  // namespace

TEST_CASE("undamped explicit Euler gains energy by 1 + (omega dt)^2 a step at any dt, and so blows up") {
  const auto context = test::context();
  const double start = spring_omega * spring_omega * spring_amplitude * spring_amplitude;
  for (const Side side : sides) {
    for (const double omega_dt : {1.0, 0.1, 0.01, 0.003}) {
      Stepped stepped(side, one_spring(Method::explicit_euler, omega_dt / spring_omega));
      const double rate = std::log1p(omega_dt * omega_dt);
      // Until the amplitude is half the spring's length: at a larger one the vertex would pass its pin.
      const int steps = std::min(40000, static_cast<int>(std::log(30.0) / rate));
      stepped.step(steps);
      const double found = std::log(spring_energy(stepped.state()) / start);
      INFO(name(side) << ", omega dt " << omega_dt << ", " << steps << " steps: e^" << found);
      CHECK(found == Approx(steps * rate).epsilon(0.003));
    }
  }
}

TEST_CASE(
    "undamped explicit Euler blows up a cloth at a half, a tenth and a twentieth of the others' limit") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const double share : {0.5, 0.1, 0.05}) {
      const double omega = 2 / (0.6285 * cloth_unit), omega_dt = 2 * share;
      const scene::Scene scene = swinging_cloth(Method::explicit_euler, omega_dt / omega);
      // The fastest vibration grows by omega_dt^2 / 2 per step: from double precision's rounding to 1 takes
      // 37 over that.
      const int steps = static_cast<int>(1.5 * 37 * 2 / (omega_dt * omega_dt));
      Stepped stepped(side, scene);
      stepped.step(steps);
      INFO(name(side) << ", " << share << " of the limit, " << steps << " steps");
      CHECK_FALSE(stepped.energy().elastic < 1.0);  // five times its weight times its size
    }
  }
}

TEST_CASE(
    "implicit Euler and BDF2 at a thousand times the others' limit never gain energy: springs, a chain, a "
    "grid, a cloth") {
  const auto context = test::context();
  const Method method = GENERATE(Method::implicit_euler, Method::bdf2);
  scene::Scene links = chain(method, 1e-3, 10, 400.0, 0.01);
  links.gravity = {0.0, 0.0, 1.0};
  scene::Scene flat = swinging_cloth(method, 1e-3);
  flat.gravity = {0.0, 0.0, 9.81};  // in its plane
  for (scene::Scene scene : {one_spring(method, 0.1), links, flat, swinging_cloth(method, 1e-3)}) {
    const model::Model model = *model::build(scene);
    scene.solver.dt = 1000 * 2 / model::omega_max(model, scene);
    scene.solver.iterations = 100;
    for (const Side side : sides) {
      Stepped stepped(side, scene);
      double before = stepped.energy().total();
      const double start = before;
      for (int n = 0; n < 10; ++n) {
        stepped.step(1);
        const double now = stepped.energy().total();
        INFO(scene::name(method) << ", " << name(side) << ", dt " << scene.solver.dt << " s, step " << n
                                 << ": " << before << " J to " << now << " J, residual "
                                 << stepped.state().residual);
        CHECK(now <= before + 1e-4 * std::abs(now - start));
        before = now;
      }
      CHECK(before < start);
    }
  }
}
