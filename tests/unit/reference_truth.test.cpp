// The reference's trajectory, rest shape and strain limit against closed forms.
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "server/reference/trajectory.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using scene::Method;

namespace {

/// Angle [rad] of the rod of `pendulum` from hanging down, in its own plane.
double angle_of(const scene::Scene& scene, const reference::State& state) {
  const glm::dvec3 arm = state.position[test::spring_end] - state.position[0];
  const glm::dvec3 down = glm::normalize(scene.gravity);
  return std::atan2(glm::cross(down, arm).x, glm::dot(down, arm));
}

}  // namespace

TEST_CASE("the trajectory of a damped spring is the closed form, and nearer to it than it says") {
  const double w = test::spring_omega, z = 0.1, wd = w * std::sqrt(1 - z * z);
  const reference::World world = world_of(test::one_spring(Method::rk4, 1.0, 2 * z * w));
  const std::vector<double> times{0.1, 0.77, 3.0};
  const Result<reference::Trajectory> found = reference::trajectory(world, times);
  REQUIRE(found);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i];
    const double u =
        test::spring_amplitude * std::exp(-z * w * t) * (std::cos(wd * t) + z * w / wd * std::sin(wd * t));
    const double off = std::abs(found->states[i].position[test::spring_end].z - test::spring_balance - u);
    INFO("at " << t << " s: off by " << off << " m, said " << found->error[i] << " m");
    // Two of six vertices move: their distance is sqrt(3) times the RMS. The finer run is off by a 15th, and
    // rounding.
    CHECK(off < std::numbers::sqrt3 * found->error[i] / 15 * 1.1 + 1e-14);
    CHECK(found->error[i] < 1e-8);
  }
}

TEST_CASE("a trajectory's times must rise, and a motion that is not finite is an error") {
  const reference::World world = world_of(test::one_spring(Method::rk4, 1.0));
  CHECK_FALSE(reference::trajectory(world, {1.0, 0.5}));
  CHECK_FALSE(reference::trajectory(world, {0.0}));
  const Result<reference::Trajectory> blown = reference::trajectory(world, {5000.0}, 5.0);
  REQUIRE_FALSE(blown);
  CHECK(blown.error().remedy.find("smaller step") != std::string::npos);
}

TEST_CASE("a stiff pendulum's period is the rod's times a factor that falls as 1 over the stiffness") {
  struct {
    double degrees, factor;
  } const cases[] = {{30, 1.017409}, {90, 1.180341}, {150, 1.762204}};
  for (const auto& [degrees, factor] : cases) {
    const double period = 2 * std::numbers::pi * std::sqrt(1.0 / 9.81) * factor;
    double off[2];
    for (int i = 0; i < 2; ++i) {
      const double k = i == 0 ? 2e4 : 4e4;
      const scene::Scene scene = test::pendulum(Method::rk4, 1.0, degrees, k);
      // Time at the lowest point, after a quarter: zero of the angle by the secant of two times around it.
      const double t0 = 0.99 * period / 4, t1 = 1.01 * period / 4;
      const auto found = reference::trajectory(world_of(scene), {t0, t1}, 0.1 / std::sqrt(k));
      REQUIRE(found);
      const double a0 = angle_of(scene, found->states[0]), a1 = angle_of(scene, found->states[1]);
      const double quarter = t0 + (t1 - t0) * a0 / (a0 - a1);
      off[i] = 4 * quarter / period - 1;
      INFO(degrees << " degrees, k " << k << " N/m: the period is off by " << off[i]);
      // The rod stretches by at most m (g + v^2 / l) / k = (3 to 5) 9.81 / k and swings slower by half that
      // share; the secant of a nearly straight line is off by 1e-6.
      CHECK(std::abs(off[i]) < 0.5 * 5 * 9.81 / k + 4e-6);
    }
    const double at_infinity = 2 * off[1] - off[0];  // the part that does not fall with the stiffness
    INFO(degrees << " degrees: extrapolated " << at_infinity);
    CHECK(std::abs(at_infinity) < 6e-6);  // half a digit of the factor, the secant, and the rod's vibration
  }
}
