// A cloth on a slope slides down it by Newton's and Coulomb's laws, however few sweeps a step has and however
// long it is.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/physics/rounding.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

constexpr std::array methods{Method::pbd, Method::xpbd, Method::vbd};
constexpr double g = 9.8;

double in_radians(double degrees) {
  return degrees * std::acos(-1.0) / 180.0;
}

/// A free cloth of 9 x 9 on a plane `degrees` from level: gravity leans, not the plane.
scene::Scene on_slope(Method method, double degrees, double friction, double dt, int iterations) {
  scene::Scene scene = bare_scene(method, dt);
  scene.solver.iterations = iterations;
  scene.gravity = g * glm::dvec3(std::sin(in_radians(degrees)), -std::cos(in_radians(degrees)), 0.0);
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{9, 9, 0.4, 0.4};
  cloth.mass = {scene::Mass::Kind::per_vertex, 0.01};
  cloth.material = scene::Springs{800.0, 400.0, 80.0, 0.02};
  scene.colliders = {{"slope", scene::Plane{}, friction, 0.0, {}}};
  const Result<model::Model> model = model::build(scene);
  REQUIRE(model);
  cloth.transform.translate.y = sim::contact_margin(scene, *model, 0);
  return scene;
}

/// Distance that the cloth's centre has slid down in `steps` steps [m].
double slid(Side side, const scene::Scene& scene, int steps) {
  Stepped stepped(side, scene);
  const auto centre = [&] {
    double sum = 0.0;
    const std::vector<glm::dvec3> position = stepped.state().position;
    for (const glm::dvec3& x : position) sum += x.x;
    return sum / static_cast<double>(position.size());
  };
  const double before = centre();
  stepped.step(steps);
  return centre() - before;
}

}  // namespace

TEST_CASE(
    "a sheet slides down a slope as far as it should at any step and with a single sweep: PBD, XPBD, VBD") {
  const auto context = test::context();
  Part part(5);
  for (const Side side : sides) {
    for (const Method method : methods) {
      for (const double degrees : {5.0, 10.0, 25.0, 45.0}) {
        for (const double dt : {1.0 / 240.0, 0.016, 1.0 / 30.0}) {
          for (const int iterations : {1, 4}) {
            for (const double friction : {0.0, 0.05, 0.3}) {
              if (part.leaves_out()) continue;  // each value of each
              const int steps = static_cast<int>(0.5 / dt);
              const double angle = in_radians(degrees);
              const double acceleration = std::max(0.0, g * (std::sin(angle) - friction * std::cos(angle)));
              const double expected = acceleration * dt * dt * steps * (steps + 1) / 2;
              const double found = slid(side, on_slope(method, degrees, friction, dt, iterations), steps);
              INFO(scene::name(method)
                   << ", " << name(side) << ", " << degrees << " degrees, friction " << friction << ", dt "
                   << dt << " s, " << iterations << " iterations: " << found << " m of " << expected);
              // All vertices slide alike, so no spring acts. float32 rounds a place within 2 m, which acts
              // like an acceleration of that over dt^2, at worst the same in every step.
              const double rounding = unit_roundoff * 2.0 * steps * (steps + 1) / 2;
              CHECK(std::abs(found - expected) < (side == Side::gpu ? 4 * rounding : 1e-6));
            }
          }
        }
      }
    }
  }
}
