// How fast a spring's vibration grows beyond a method's limit, against the reference that steps this spring.
#include <cmath>

#include "server/lab/measure/mode_growth.h"
#include "server/model/stability.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// Growth of the amplitude per step [e-folds], from kinetic and elastic energy about the balance. `expected`
/// only sets the duration: until the fastest growing part is alone, and then as long again, from 1e-9 m to at
/// most 1e-4 m.
double measured_growth(Method method, double dt, double damping, double expected) {
  constexpr double balance = 1.0 + 1e-9;
  Stepped stepped(Side::reference, one_spring(method, dt, damping, 1e-9));
  const auto log_amplitude = [&] {
    const reference::State state = stepped.state();
    const double off = spring_omega * (state.position[spring_end].z - balance),
                 v = state.velocity[spring_end].z;
    return 0.5 * std::log(off * off + v * v);
  };
  const int apart = static_cast<int>(std::ceil(5.5 / expected));
  stepped.step(apart);
  const double before = log_amplitude();
  stepped.step(apart);
  return (log_amplitude() - before) / apart;
}

}  // namespace

TEST_CASE("beyond a method's limit a spring grows as fast as the lab expects, and below it not at all") {
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    for (const double z : {0.05, 0.3}) {
      const double damping = 2 * z * spring_omega;
      const model::Mode mode{spring_omega * spring_omega, damping};
      const double limit = model::dt_limit(method, mode);
      for (const double beyond : {1.01, 1.03}) {
        INFO(scene::name(method) << ", z = " << z << ", " << beyond << " of the limit");
        const double expected = lab::growth_a_step(method, mode, beyond * limit);
        CHECK(expected > 0.0);
        // Within a turn the energy of a damped vibration swings by at most 2 z: 0.6 of 11 e-folds.
        CHECK(measured_growth(method, beyond * limit, damping, expected) == Approx(expected).epsilon(0.06));
      }
      CHECK(lab::growth_a_step(method, mode, 0.999 * limit) == 0.0);
    }
  }
}

TEST_CASE("the shortest step whose growth shows is where growth times steps is what is asked for") {
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    const model::Mode mode{100.0, method == Method::verlet ? 0.0 : 0.4};
    const double dt = lab::shortest_visible(method, mode, 600, 11.5);
    INFO(scene::name(method));
    CHECK(dt > model::dt_limit(method, mode));
    CHECK(600 * lab::growth_a_step(method, mode, dt) == Approx(11.5).epsilon(1e-6));
  }
  // Without damping explicit Euler multiplies by sqrt(1 + (omega dt)^2): (omega dt)^2 / 2 per step.
  const double dt = lab::shortest_visible(Method::explicit_euler, {100.0, 0.0}, 1000, 0.5);
  CHECK(dt == Approx(std::sqrt(2 * 0.5 / 1000) / 10).epsilon(1e-3));
}
