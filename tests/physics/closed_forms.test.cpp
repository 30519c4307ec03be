// Motions whose discrete solution is known: the GPU and the double-precision reference against formulas.
#include <cmath>
#include <numbers>

#include "tests/physics/rounding.h"
#include "tests/physics/stage.h"

using namespace clothlab;

namespace {

/// A 5 x 5 cloth that falls freely at -8 m/s^2; its rest lengths and time step are exact in binary.
const char* const falling_sheet = R"({"version": 1, "gravity": [0, -8, 0],
  "cloths": [{"mesh": {"grid": {"columns": 5, "rows": 5, "width": 1, "height": 1}},
              "transform": {"translate": [0, 4, 0]}, "mass": {"per_vertex": 0.125}}],
  "solver": {"dt": 0.0009765625}})";

/// Two free vertices side by side, each hung from a pinned one by a spring of 1 m and 16 N/m, pulled along z.
/// The spring between the two stays unstretched, so each vertex moves like the single spring of the closed
/// form.
scene::Scene one_spring(double omega_dt, double damping = 0.0) {
  scene::Scene scene = scene_of(R"({"version": 1, "gravity": [0, 0, 1.6],
    "cloths": [{"mesh": {"grid": {"columns": 2, "rows": 2, "width": 1, "height": 1}}, "mass": {"per_vertex": 1},
                "material": {"structural": 16, "shear": 0, "bend": 0, "damping": 0},
                "pins": [{"at": "edge:row:0"}]}]})");
  scene.cloths[0].springs().damping = damping;
  scene.solver.dt = omega_dt / 4.0;  // omega = sqrt(k/m) = 4 / s
  return scene;
}

/// z after n steps from rest, exactly: u = z - z_equilibrium obeys u_{n+1} - 2 cos(theta) u_n + u_{n-1} = 0
/// with cos(theta) = 1 - (omega dt)^2 / 2, and v_0 = 0 makes that u_n = u_0 cos((n + 1/2) theta) / cos(theta
/// / 2).
double spring_after(int n, double omega_dt) {
  const double theta = std::acos(1.0 - 0.5 * omega_dt * omega_dt);
  return 1.1 - 0.1 * std::cos((n + 0.5) * theta) / std::cos(0.5 * theta);
}

}  // namespace

TEST_CASE("free fall is exact to the recurrence, bit by bit where it is exact in binary") {
  const auto context = test::context();
  // y_N = y_0 - g dt^2 N (N + 1) / 2: with these numbers a multiple of 2^-17, so float32 holds it exactly.
  const auto simulation = test::simulation(scene_of(falling_sheet));
  int step = 0;
  for (const int until : {1, 2, 10, 100, 500}) {
    simulation->step(static_cast<std::uint32_t>(until - step));
    step = until;
    const double expected = 4.0 - 8.0 * 0x1p-20 * step * (step + 1) / 2.0;
    const sim::State state = simulation->read_state();
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      INFO("step " << step << ", vertex " << i);
      CHECK(static_cast<double>(state.position[i].y) == expected);
      CHECK(static_cast<double>(state.velocity[i].y) == -8.0 * 0x1p-10 * step);
    }
  }
}

TEST_CASE("a sheet in free fall feels no relative motion") {
  scene::Scene scene = scene_of(falling_sheet);
  scene.gravity = {1.3, -9.8, 0.7};
  const reference::World world = world_of(scene);
  reference::State state = reference::at_rest(world);
  for (int n = 0; n < 500; ++n) reference::step(world, state);
  const glm::dvec3 fallen = scene.gravity * (0x1p-20 * 500 * 501 / 2.0);
  for (std::size_t i = 0; i < state.position.size(); ++i) {
    const glm::dvec3 error = state.position[i] - (world.model.rest_position[i] + fallen);
    CHECK(glm::length(error) < 500 * 4 * 0x1p-53 * 8);  // 500 roundings of numbers below 8
  }
}

TEST_CASE("one spring follows the closed form of symplectic Euler up to its stability limit") {
  const auto context = test::context();
  for (const double omega_dt : {0.1, 0.5, 1.0, 1.5, 1.9}) {
    const scene::Scene scene = one_spring(omega_dt);
    const auto simulation = test::simulation(scene);
    const reference::World world = world_of(scene);
    reference::State exact = reference::at_rest(world);
    const double theta = std::acos(1.0 - 0.5 * omega_dt * omega_dt);
    for (int n = 1; n <= 200; ++n) {
      simulation->step(1);
      reference::step(world, exact);
      const double expected = spring_after(n, omega_dt);
      INFO("omega dt = " << omega_dt << ", step " << n);
      // Each step rounds z (about 1 m) and dt v; the recurrence carries a disturbance d on as d sin(n theta)
      // / sin(theta).
      const double roundings = 8.0 * n / std::sin(theta);
      CHECK(std::abs(exact.position[2].z - expected) < roundings * 0x1p-53);
      CHECK(std::abs(simulation->read_state().position[2].z - expected) < roundings * unit_roundoff);
    }
  }
}

TEST_CASE("one spring holds just below omega dt = 2 and diverges just above") {
  const auto context = test::context();
  for (const double omega_dt : {1.99, 2.01}) {
    const auto simulation = test::simulation(one_spring(omega_dt));
    simulation->step(2000);
    const double reach = std::abs(simulation->read_state().position[2].z - 1.1);
    INFO("omega dt = " << omega_dt << ": " << reach << " m from equilibrium");
    // Below, at most 0.1 / cos(theta / 2); above, growth by exp(acosh((omega dt)^2 / 2 - 1)) = 1.22 a step.
    if (omega_dt < 2.0)
      CHECK(reach < 0.1 / std::sqrt(1.0 - omega_dt * omega_dt / 4.0) * 1.01);
    else
      CHECK_FALSE(reach < 1e6);
  }
}

TEST_CASE("one damped spring loses its limit as lagged damping says: 2 (sqrt(1 + z^2) - z)") {
  const auto context = test::context();
  const double z = 0.5, limit = 2.0 * (std::sqrt(1.0 + z * z) - z),
               damping = 2.0 * z * 4.0;  // c = 2 z sqrt(k m)
  for (const double share : {0.98, 1.02}) {
    const auto simulation = test::simulation(one_spring(share * limit, damping));
    simulation->step(2000);
    const double reach = std::abs(simulation->read_state().position[2].z - 1.1);
    INFO("omega dt = " << share * limit << ": " << reach << " m from equilibrium");
    CHECK((reach < 0.1) == (share < 1.0));
  }
}

TEST_CASE("air drag slows a falling sheet as v_{n+1} = v_n + (g - drag v_n) dt") {
  const auto context = test::context();
  scene::Scene scene = scene_of(falling_sheet);
  scene.air_drag =
      4.0;  // a power of two, but the product below is rounded: 3 roundings a step, none of them growing
  const auto simulation = test::simulation(scene);
  simulation->step(1000);
  double v = 0.0;
  for (int n = 0; n < 1000; ++n) v += (-8.0 - 4.0 * v) * scene.solver.dt;
  CHECK(std::abs(simulation->read_state().velocity[12].y - v) < 1000 * 3 * unit_roundoff * 2.0);
  CHECK(v == Approx(-2.0).epsilon(0.03));  // near its terminal speed g / drag
}

TEST_CASE("pins are where their motions' closed forms put them") {
  const auto context = test::context();
  scene::Scene scene = scene_of(R"({"version": 1, "cloths": [{"mesh": {"grid": {"columns": 3, "rows": 2}},
    "pins": [{"at": "corner:0,0", "motion": {"oscillate": {"axis": [0, 0, 2], "amplitude": 0.2, "frequency": 0.5}}},
             {"at": "corner:1,0", "motion": {"linear": {"velocity": [0.1, -0.2, 0.3]}}},
             {"at": "corner:2,0",
              "motion": {"spin": {"axis": [0, 3, 0], "center": [0, 0, 0], "degrees_per_second": 90}}},
             {"at": "corner:0,1"}]}]})");
  const auto simulation = test::simulation(scene);
  simulation->step(500);
  const sim::State state = simulation->read_state();
  const double t = 0.5, quarter = std::numbers::pi / 4.0;  // turned by 45 degrees after half a second
  const auto check = [&](std::size_t vertex, glm::dvec3 x, glm::dvec3 v) {
    INFO("vertex " << vertex);
    CHECK(glm::distance(glm::dvec3(state.position[vertex]), x) < 8 * unit_roundoff);
    CHECK(glm::distance(glm::dvec3(state.velocity[vertex]), v) < 8 * unit_roundoff);
  };
  check(0, {-0.5, 0, 0.2 * std::sin(std::numbers::pi * t)},
        {0, 0, 0.2 * std::numbers::pi * std::cos(std::numbers::pi * t)});
  check(1, glm::dvec3(0.1, -0.2, 0.3) * t, {0.1, -0.2, 0.3});
  // From +x towards -z: counter-clockwise seen from +y.
  check(2, {0.5 * std::cos(quarter), 0, -0.5 * std::sin(quarter)},
        glm::dvec3(-0.5 * std::sin(quarter), 0, -0.5 * std::cos(quarter)) * (std::numbers::pi / 2.0));
  check(3, {-0.5, 0, 1}, {0, 0, 0});
}
