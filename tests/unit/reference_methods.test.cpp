// The double-precision reference: one step of each method on a spring is the linear map of theory, and so is
// every later step; and laws that hold for whole cloths.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/reference/reference.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr double rounding = 0x1p-52;

/// Displacement from balance [m] and velocity [m/s] of the end of one_spring after `steps` steps.
std::array<double, 2> spring_after(const scene::Scene& scene, int steps) {
  const reference::World world = world_of(scene);
  reference::State state = reference::at_rest(world);
  for (int n = 0; n < steps; ++n) reference::step(world, state);
  return {state.position[test::spring_end].z - test::spring_balance, state.velocity[test::spring_end].z};
}

using Map = std::array<std::array<double, 2>, 2>;

/// u, v after `steps` applications of the map to (amplitude, 0).
std::array<double, 2> iterate(const Map& map, int steps) {
  double u = test::spring_amplitude, v = 0.0;
  for (int n = 0; n < steps; ++n) {
    const double u_next = map[0][0] * u + map[0][1] * v;
    v = map[1][0] * u + map[1][1] * v;
    u = u_next;
  }
  return {u, v};
}

/// Compares the reference with the map over 50 steps, at omega dt of 0.3 and damping ratio z. Both round a
/// few times per step; explicit Euler grows by at most (1 + 0.3^2)^25 = 9.
template <class MapOf>
void check_map(Method method, double z, MapOf map_of) {
  const double w = test::spring_omega, dt = 0.3 / w, c = 2 * z * w;
  const scene::Scene scene = test::one_spring(method, dt, c);
  for (const int steps : {1, 2, 50}) {
    const auto found = spring_after(scene, steps), expected = iterate(map_of(w * w, c, dt), steps);
    INFO(steps << " steps, z " << z);
    CHECK(std::abs(found[0] - expected[0]) < 2000 * rounding);
    CHECK(std::abs(found[1] - expected[1]) < 2000 * w * rounding);
  }
}

}  // namespace

TEST_CASE("explicit Euler's step of a spring takes both slopes from its start") {
  for (const double z : {0.0, 0.1})
    check_map(Method::explicit_euler, z, [](double k, double c, double dt) {
      return Map{{{1.0, dt}, {-k * dt, 1.0 - c * dt}}};
    });
}

TEST_CASE("symplectic Euler's step of a spring moves by the new velocity") {
  for (const double z : {0.0, 0.1})
    check_map(Method::symplectic_euler, z, [](double k, double c, double dt) {
      return Map{{{1.0 - k * dt * dt, dt * (1.0 - c * dt)}, {-k * dt, 1.0 - c * dt}}};
    });
}

TEST_CASE("backward Euler's step of a spring is the inverse of an explicit step back") {
  for (const double z : {0.0, 0.1})
    check_map(Method::implicit_euler, z, [](double k, double c, double dt) {
      const double d = 1.0 + c * dt + k * dt * dt;
      return Map{{{(1.0 + c * dt) / d, dt / d}, {-k * dt / d, 1.0 / d}}};
    });
}

TEST_CASE(
    "BDF2's step of a spring solves 3 x - 4 x_n + x_(n-1) = 2 h v, and so for v, after one of Euler's") {
  const double w = test::spring_omega, h = 0.3 / w, t = 2.0 / 3.0 * h, k = w * w;
  for (const double z : {0.0, 0.1}) {
    const double c = 2 * z * w;
    const reference::World world = world_of(test::one_spring(Method::bdf2, h, c));
    reference::State state = reference::at_rest(world);
    const double first = 1.0 + c * h + k * h * h, further = 1.0 + c * t + k * t * t;
    std::array<double, 2> before{test::spring_amplitude, 0.0};
    std::array<double, 2> now{(1.0 + c * h) / first * before[0], -k * h / first * before[0]};
    for (int n = 1; n < 50; ++n) {
      reference::step(world, state);
      INFO("step " << n << ", z " << z);
      CHECK(std::abs(state.position[test::spring_end].z - test::spring_balance - now[0]) < 2000 * rounding);
      CHECK(std::abs(state.velocity[test::spring_end].z - now[1]) < 2000 * w * rounding);
      const double x = (4.0 * now[0] - before[0]) / 3.0, v = (4.0 * now[1] - before[1]) / 3.0;
      before = now;
      now = {((1.0 + c * t) * x + t * v) / further, (v - k * t * x) / further};
    }
  }
}

TEST_CASE("RK4's step of a spring is the exponential's series up to the fourth power") {
  for (const double z : {0.0, 0.1})
    check_map(Method::rk4, z, [](double k, double c, double dt) {
      const Map a{{{0.0, dt}, {-k * dt, -c * dt}}};
      Map sum{{{1.0, 0.0}, {0.0, 1.0}}}, power = sum;
      for (int n = 1; n <= 4; ++n) {
        Map next{};
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            for (int l = 0; l < 2; ++l) next[i][j] += power[i][l] * a[l][j] / n;
        power = next;
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) sum[i][j] += power[i][j];
      }
      return sum;
    });
}

TEST_CASE(
    "Verlet's position on a spring is x' = 2 x - x_prev + a dt^2, and its velocity a central difference") {
  const double w = test::spring_omega, dt = 0.3 / w, q = w * w * dt * dt;
  const reference::World world = world_of(test::one_spring(Method::verlet, dt));
  reference::State state = reference::at_rest(world);
  double before = test::spring_amplitude * (1.0 - q / 2), now = test::spring_amplitude;  // starts at rest
  for (int n = 0; n < 50; ++n) {
    reference::step(world, state);
    const double next = 2 * now - before - q * now;
    CHECK(std::abs(state.position[test::spring_end].z - test::spring_balance - next) <
          200 * (n + 1) * rounding);
    // The velocity shown is predicted from the step's start: v_n + dt a_n, with v_n the central difference
    // there.
    const double predicted = (next - before) / (2 * dt) - w * w * dt * now;
    CHECK(std::abs(state.velocity[test::spring_end].z - predicted) < 2000 * (n + 1) * rounding);
    before = now;
    now = next;
  }
}

TEST_CASE("Verlet starts anew where its half step is of length 0, as after a start") {
  const double dt = 0.05;
  const reference::World world = world_of(test::one_spring(Method::verlet, dt));
  reference::State state = reference::at_rest(world), fresh;
  for (int n = 0; n < 10; ++n) reference::step(world, state);
  state.velocity[test::spring_end] = {0.0, 0.0, 0.25};
  state.half_dt[test::spring_end] = 0.0;
  fresh.position = state.position;
  fresh.velocity = state.velocity;
  fresh.contacts = state.contacts;
  reference::step(world, state);
  reference::step(world, fresh);
  CHECK(state.position[test::spring_end] == fresh.position[test::spring_end]);
  CHECK(state.velocity[test::spring_end] == fresh.velocity[test::spring_end]);
}

TEST_CASE(
    "a step of backward Euler on a cloth is solved to rounding, and many Newton steps come to the "
    "same") {
  for (const double damping : {0.0, 1e-3}) {
    scene::Scene scene = test::swinging_cloth(Method::implicit_euler, 5e-3);
    scene.cloths[0].springs().damping = damping;
    scene.solver.iterations = 40;
    const reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    for (int n = 0; n < 4; ++n) {
      reference::State other = state;
      reference::step(world, state);
      reference::limited_newton_step(world, other);
      INFO("step " << n << ", damping " << damping << ": residuals " << state.residual << ", "
                   << other.residual);
      CHECK(state.residual < 1e-12);
      CHECK(other.residual < 1e-12);
      double apart = 0.0;
      for (std::size_t i = 0; i < state.position.size(); ++i)
        apart = std::max(apart, glm::distance(state.position[i], other.position[i]));
      CHECK(apart < 1e-10);
    }
  }
}

TEST_CASE("one Newton step of a spring at balance solves the linearised equation exactly") {
  // On a straight spring the force is linear, so that one Newton step is backward Euler.
  scene::Scene scene = test::one_spring(Method::implicit_euler, 0.2, 1.5);
  scene.solver.iterations = 1;
  const reference::World world = world_of(scene);
  reference::State one = reference::at_rest(world), full = one;
  for (int n = 0; n < 10; ++n) {
    reference::limited_newton_step(world, one);
    reference::step(world, full);
    CHECK(glm::distance(one.position[test::spring_end], full.position[test::spring_end]) < 100 * rounding);
  }
}

TEST_CASE(
    "every method carries a pin's whole motion: a sheet held everywhere is where the closed form says") {
  for (const Method method : {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4,
                              Method::implicit_euler, Method::bdf2}) {
    scene::Scene scene = test::one_spring(method, 0.01);
    const scene::Linear sideways{{0.3, 0.0, 0.0}};
    for (const int row : {0, 1, 2})
      scene.cloths[0].pins.push_back({scene::AtEdge{scene::AtEdge::Line::row, row}, sideways});
    const reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    for (int n = 0; n < 100; ++n) reference::step(world, state);
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      CHECK(glm::distance(state.position[i], world.model.rest_position[i] + glm::dvec3(0.3, 0, 0)) <
            8 * rounding);
      CHECK(glm::distance(state.velocity[i], glm::dvec3(0.3, 0, 0)) < 8 * rounding);
    }
  }
}
