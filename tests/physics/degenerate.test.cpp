// Scenes at the edge of what the laws define: no direction, no length, no time to react.
#include <algorithm>
#include <cmath>

#include "tests/physics/stage.h"

using namespace clothlab;

namespace {

bool finite(const sim::State& state) {
  for (const auto* values : {&state.position, &state.velocity})
    for (const glm::vec3& value : *values)
      if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z)) return false;
  return true;
}

/// A free cloth that a sphere, moving along +z at `speed` [m/s], hits in the middle.
scene::Scene struck_sheet(double speed, double radius) {
  scene::Scene scene = scene_of(R"({"version": 1, "gravity": [0, 0, 0],
    "cloths": [{"mesh": {"grid": {"columns": 21, "rows": 21, "width": 1, "height": 1}}, "mass": {"per_vertex": 0.001},
                "transform": {"translate": [0, 0.5, 0], "rotate": [90, 0, 0]},
                "material": {"structural": 200, "shear": 100, "bend": 20, "damping": 0.01}}],
    "colliders": [{"sphere": {"center": [0, 0, -0.5], "radius": 0.25}, "friction": 0.3,
                   "motion": {"linear": {"velocity": [0, 0, 1]}}}]})");
  std::get<scene::Linear>(scene.colliders[0].motion).velocity.z = speed;
  std::get<scene::Sphere>(scene.colliders[0].shape).radius = radius;
  return scene;
}

}  // namespace

TEST_CASE("vertices in one place give no NaN, with springs, self-collision and a sphere centred on them") {
  const auto context = test::context();
  const auto simulation = test::simulation(scene_of(R"({"version": 1,
    "cloths": [{"mesh": {"vertices": [[0,0,0], [0,0,0], [0,0,0], [1,0,0], [0,0,1]],
                         "triangles": [[0,1,2], [0,1,3], [1,2,4], [3,4,0]]}, "mass": {"per_vertex": 0.1}}],
    "colliders": [{"sphere": {"center": [0, 0, 0], "radius": 0.2}}],
    "self_collision": {"thickness": 0.05}})"));
  for (int n = 0; n < 100; ++n) {
    simulation->step(1);
    REQUIRE(finite(simulation->read_state()));
  }
  CHECK(simulation->diagnose().finite);
}

TEST_CASE("the sphere is never entered, at 1 and at 50 m/s") {
  const auto context = test::context();
  for (const double speed : {1.0, 50.0}) {
    for (const double radius : {0.25, 0.06}) {  // at 50 m/s and 1 ms, 50 mm a step
      const scene::Scene scene = struck_sheet(speed, radius);
      const auto simulation = test::simulation(scene);
      const int steps = static_cast<int>(0.9 / speed / scene.solver.dt);
      double nearest = 1e9;
      for (int n = 1; n <= steps; ++n) {
        simulation->step(1);
        const glm::dvec3 centre(0, 0, -0.5 + speed * n * scene.solver.dt);
        for (const glm::vec3& x : simulation->read_state().position)
          nearest = std::min(nearest, glm::distance(glm::dvec3(x), centre));
      }
      INFO(speed << " m/s, radius " << radius << " m: nearest vertex at " << nearest << " m");
      CHECK(nearest >= radius);
      CHECK(nearest < 1.1 * radius);  // they met
      const glm::vec3 middle = simulation->read_state().position[10 * 21 + 10];
      // the sphere pushes it ahead and does not pass it
      CHECK(middle.z > -0.5 + speed * steps * scene.solver.dt);
    }
  }
}

TEST_CASE("a sphere far smaller than its path in a step still takes the vertex in its way along") {
  const auto context = test::context();
  // A sphere of 4 mm moves 50 mm per step: a test of end points alone would miss it.
  const scene::Scene scene = struck_sheet(50.0, 0.002);
  const auto simulation = test::simulation(scene);
  simulation->step(11);
  CHECK(simulation->read_state().velocity[10 * 21 + 10].z > 25.0f);
}
