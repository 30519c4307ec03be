// Energy of an undamped motion under each method, on the GPU and in the reference: kept without a trend, or
// changed by the method's own law.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "server/model/stability.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

constexpr int steps = 10000;
constexpr double float32_rounding = 0x1p-24;

/// Energy of both copies of one_spring about its balance [J].
double spring_energy(const reference::State& state) {
  const double u = state.position[spring_end].z - spring_balance, v = state.velocity[spring_end].z;
  return v * v + spring_omega * spring_omega * u * u;
}
constexpr double spring_start = spring_omega * spring_omega * spring_amplitude * spring_amplitude;

struct Line {
  double drift;  ///< of the fitted line, from the first sample to the last
  double error;  ///< standard error of the drift, from the samples' distances to the line
};

Line fit(const std::vector<double>& samples) {
  const auto count = static_cast<double>(samples.size());
  const double mean = std::accumulate(samples.begin(), samples.end(), 0.0) / count;
  double xy = 0.0, xx = 0.0, rest = 0.0;
  const auto x_of = [&](std::size_t i) { return static_cast<double>(i) - (count - 1) / 2; };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    xy += x_of(i) * (samples[i] - mean);
    xx += x_of(i) * x_of(i);
  }
  const double slope = xy / xx;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double off = samples[i] - mean - slope * x_of(i);
    rest += off * off;
  }
  return {slope * count, std::sqrt(rest / (count - 2) / xx) * count};
}

}  // namespace

TEST_CASE(
    "on one spring symplectic Euler and Verlet keep the energy for 10,000 steps, between bounds and without "
    "slope") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const Method method : {Method::symplectic_euler, Method::verlet}) {
      for (const double y : {0.2, 0.6, 1.2}) {  // omega dt
        Stepped stepped(side, one_spring(method, y / spring_omega));
        std::vector<double> energy;
        for (int n = 0; n < steps; ++n) {
          stepped.step(1);
          energy.push_back(spring_energy(stepped.state()) / spring_start);
        }
        // Symplectic Euler keeps v^2 + (omega u)^2 - y omega u v exactly, and so the energy to 1 +- y/2.
        // Verlet keeps v_n^2 + (1 - y^2/4) (omega u)^2, and the velocity shown is ahead of that by up to
        // y^2/2 of the half step's.
        const double low = method == Method::verlet ? 1 - y * y / 4 : 1 / (1 + y / 2);
        const double high =
            method == Method::verlet ? (1 + y * y / 2) * (1 + y * y / 2) / (1 - y * y / 4) : 1 / (1 - y / 2);
        const auto [least, most] = std::minmax_element(energy.begin(), energy.end());
        // A line through an oscillation of amplitude A and 2 theta per step drifts by up to 6 A / (N sin
        // theta) by itself; float32 rounds z of 1.2 m and v in each step, so that the energy makes a random
        // walk.
        const double theta = 2 * std::asin(y / 2), amplitude = (*most - *least) / 2;
        const double walk = 3 * std::sqrt(steps) * 2 * 1.2 * float32_rounding * spring_omega / 0.4 *
                            (1 / std::cos(theta / 2));
        const double error = 6 * amplitude / (steps * std::sin(theta)) + (side == Side::gpu ? 4 * walk : 0.0);
        INFO(scene::name(method) << ", " << name(side) << ", omega dt " << y << ": energy " << *least
                                 << " to " << *most << ", drift " << fit(energy).drift << ", error bar "
                                 << error);
        CHECK(*least > low - error);
        CHECK(*most < high + error);
        CHECK(std::abs(fit(energy).drift) < error);
        CHECK(error < 0.01);  // of the energy, over 10,000 steps: the error bar is small enough
      }
    }
  }
}

TEST_CASE(
    "on a chain of ten links symplectic Euler and Verlet keep the energy for 10,000 steps without slope") {
  const auto context = test::context();
  const double k = 400.0, mass = 0.01, fastest = 2 * std::sqrt(k / mass);
  for (const Side side : sides) {
    for (const Method method : {Method::symplectic_euler, Method::verlet}) {
      for (const double y : {0.2, 0.6}) {
        scene::Scene scene = chain(method, y / fastest, 10, k, mass);
        scene.gravity = {0.0, 0.0, 50.0};
        Stepped stepped(side, scene);
        const double start = stepped.energy().total();
        double kinetic = 0.0;
        std::vector<double> blocks;  // means over 500 steps, several periods of the slowest vibration
        for (int block = 0; block < 20; ++block) {
          double sum = 0.0;
          for (int n = 0; n < 500; ++n) {
            stepped.step(1);
            const reference::Energy now = stepped.energy();
            sum += now.total() - start;
            kinetic = std::max(kinetic, now.kinetic);
          }
          blocks.push_back(sum / 500);
        }
        const Line line = fit(blocks);
        INFO(scene::name(method) << ", " << name(side) << ", omega dt " << y << ": drift "
                                 << line.drift / kinetic << ", error bar " << line.error / kinetic
                                 << " of the vibrations' energy");
        CHECK(std::abs(line.drift) < 3 * line.error);  // 3 standard errors
        CHECK(3 * line.error < 0.01 * kinetic);        // and the standard errors are small
      }
    }
  }
}

namespace {

/// Checks that the energy of a swinging cloth stays within a bound of what it was at the start. `y` is omega
/// dt of the fastest vibration: no vibration's relative energy error is larger than that of one spring at
/// this y, which is y/2, and y^2/2 for Verlet.
void check_bounded(Side side, const scene::Scene& scene, double y, double least_kinetic) {
  Stepped stepped(side, scene);
  const double start = stepped.energy().total();
  double least = 0.0, most = 0.0, kinetic = 0.0;
  for (int n = 0; n < steps; n += 10) {
    stepped.step(10);
    const reference::Energy now = stepped.energy();
    least = std::min(least, now.total() - start);
    most = std::max(most, now.total() - start);
    kinetic = std::max(kinetic, now.kinetic);
  }
  const Method method = scene.solver.method;
  const double bound = (method == Method::verlet ? y * y / 2 : y / 2) * kinetic;
  INFO(scene::name(method) << ", " << name(side) << ": " << least << " to " << most << " J, bound " << bound
                           << " J");
  CHECK(kinetic > least_kinetic);
  CHECK(least > -bound);
  CHECK(most < bound);
}

}  // namespace

TEST_CASE(
    "on a swinging cloth, buckling and all, symplectic Euler and Verlet keep the energy bounded for 10,000 "
    "steps") {
  const auto context = test::context();
  constexpr double y = 0.3;
  for (const Side side : sides)
    for (const Method method : {Method::symplectic_euler, Method::verlet})
      check_bounded(side, swinging_cloth(method, y / 2 * 0.6285 * cloth_unit), y, 1e-3);
}

TEST_CASE(
    "on a swinging sheet of finite elements symplectic Euler and Verlet keep the energy bounded for 10,000 "
    "steps") {
  const auto context = test::context();
  constexpr double y = 0.3;
  for (const Side side : sides)
    for (const Method method : {Method::symplectic_euler, Method::verlet}) {
      scene::Scene scene = sheet_of_elements(method, 1e-4, 9);
      scene.gravity = {0.0, -9.81, 0.0};
      scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
      scene.solver.dt = y / model::omega_max(*model::build(scene), scene);
      check_bounded(side, scene, y, 1e-3);
    }
}

TEST_CASE("on a swinging sheet of finite elements implicit Euler's energy falls at every look") {
  const auto context = test::context();
  for (const Side side : sides) {
    scene::Scene scene = sheet_of_elements(Method::implicit_euler, 2e-3, 9);
    scene.gravity = {0.0, -9.81, 0.0};
    scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
    scene.solver.iterations = 10;
    scene.solver.tolerance = 1e-6;
    Stepped stepped(side, scene);
    const double start = stepped.energy().total();
    double before = start, kinetic = 0.0;
    for (int n = 0; n < 250; ++n) {
      stepped.step(1);
      const reference::Energy now = stepped.energy();
      kinetic = std::max(kinetic, now.kinetic);
      INFO(name(side) << ", step " << n);
      // The solver leaves 1e-6 of the momentum, and float32 as much of the places.
      CHECK(now.total() < before + 1e-5 * kinetic);
      before = now.total();
    }
    // The second half swing is less high: a pendulum's swings lose dt/2 omega^2 of their energy in a second
    // alone, and the stretching far more.
    CHECK(before < start - 0.02 * kinetic);
  }
}

TEST_CASE(
    "on one spring implicit Euler loses energy by 1/(1 + y^2) a step, RK4 by 1 - y^6/72 + y^8/576, y = omega "
    "dt, BDF2 by the square of the root of its recurrence") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const double y : {0.03, 0.1, 0.3}) {
      scene::Scene scene = one_spring(Method::implicit_euler, y / spring_omega);
      scene.solver.tolerance = 1e-7;
      const double law = std::log1p(y * y);
      const int count = std::min(steps, static_cast<int>(3.0 / law));  // to a twentieth of the energy
      Stepped stepped(side, scene);
      stepped.step(count);
      INFO("implicit Euler, " << name(side) << ", y " << y << ", " << count << " steps");
      CHECK(-std::log(spring_energy(stepped.state()) / spring_start) == Approx(count * law).epsilon(0.003));
    }
    for (const double y : {0.2, 0.5, 1.0}) {
      scene::Scene scene = one_spring(Method::bdf2, y / spring_omega);
      scene.solver.tolerance = 1e-7;
      const std::complex<double> z(0.0, y);  // (3 - 2 z) root^2 - 4 root + 1 = 0; the other one starts at 1/3
      const double root = std::abs((2.0 + std::sqrt(1.0 + 2.0 * z)) / (3.0 - 2.0 * z)),
                   law = -2.0 * std::log(root);
      const int count = std::min(steps, static_cast<int>(3.0 / law));
      Stepped stepped(side, scene);
      stepped.step(20);  // the first one is implicit Euler's, and what it begins of the other root is gone
      const double before = spring_energy(stepped.state());
      stepped.step(count);
      INFO("BDF2, " << name(side) << ", y " << y << ", " << count << " steps");
      CHECK(-std::log(spring_energy(stepped.state()) / before) == Approx(count * law).epsilon(0.02));
    }
    for (const double y : {0.2, 0.5, 1.0, 2.0}) {
      const double law = -std::log1p(std::pow(y, 6) * (y * y / 8 - 1) / 72);
      const int count = std::min(steps, static_cast<int>(3.0 / law));
      Stepped stepped(side, one_spring(Method::rk4, y / spring_omega));
      stepped.step(count);
      INFO("RK4, " << name(side) << ", y " << y << ", " << count << " steps");
      CHECK(-std::log(spring_energy(stepped.state()) / spring_start) == Approx(count * law).epsilon(0.003));
    }
  }
}
