// Under surface contact a pin that moves waits where cloth or a body is in its way, and comes after its
// motion once the way is free.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "tests/body_meshes.h"
#include "tests/catch.h"
#include "tests/methods.h"
#include "tests/physics/stage.h"

using namespace clothlab;
using glm::dvec3;

namespace {

constexpr int across = 9;  // vertices of a side

/// A sheet of which one row is lifted by 0.2 m and let down again within a second. A lid is 0.1 m above one
/// half of the row: a sheet whose pins hold it whole, or, if `of_body`, a cube.
scene::Scene under_a_lid(scene::Method method, bool of_body) {
  scene::Scene scene = scene_of(R"({"version": 1,
    "cloths": [{"mesh": {"grid": {"columns": 9, "rows": 9, "width": 0.4, "height": 0.4}},
                "mass": {"area_density": 0.15},
                "material": {"structural": 20, "shear": 10, "bend": 1, "damping": 0.02},
                "pins": [{"at": "edge:row:4",
                          "motion": {"oscillate": {"axis": [0, 1, 0], "amplitude": 0.2, "frequency": 0.5}}}]},
               {"mesh": {"grid": {"columns": 5, "rows": 9, "width": 0.3, "height": 0.6}},
                "transform": {"translate": [-0.203, 0.1, -0.107]},
                "pins": [{"at": {"box": [[-9, -9, -9], [9, 9, 9]]}}]}],
    "self_collision": {"kind": "surface", "thickness": 0.008, "friction": 0.2},
    "air_drag": 0.5, "solver": {"dt": 0.001, "iterations": 5}})");
  scene.solver.method = method;
  if (of_body) {
    scene.cloths.pop_back();
    scene::Transform place;
    place.translate = {-0.24, 0.35, 0.2};
    place.scale = 0.25;
    scene.colliders = {test::body_of(test::cube_mesh(), place)};
  }
  return scene;
}

/// The heights of the row's two ends [m]: under the lid, and beside it.
std::pair<double, double> ends(const sim::State& state) {
  return {state.position[4 * across].y, state.position[4 * across + across - 1].y};
}

}  // namespace

TEST_CASE(
    "a pin waits where cloth or a body is in its way, with all that follow its motion, and comes after it") {
  const auto context = test::context();
  for (const bool of_body : {false, true})
    for (const scene::Method method : scene::methods) {
      if (of_body && method != scene::Method::symplectic_euler && method != scene::Method::xpbd) continue;
      // One method that changes velocities first meets a sheet, one that sweeps a body, and one that solves.
      const bool sweeps = method == scene::Method::xpbd;
      if (!test::thorough() && (!test::tried(method) || method == scene::Method::vbd || sweeps != of_body))
        continue;
      const auto simulation = test::simulation(under_a_lid(method, of_body));
      const model::Model& model = simulation->model();
      const model::Surfaces surfaces = model::surfaces_of(model);
      INFO(scene::name(method) << (of_body ? " under a cube" : " under a sheet"));
      for (int look = 1; look <= 20; ++look) {
        simulation->step(50);
        const sim::State state = simulation->read_state();
        std::vector<dvec3> places(state.position.begin(), state.position.end());
        for (const dvec3& x : model::body_positions(model, simulation->time()))
          places.emplace_back(glm::vec3(x));
        INFO("at " << simulation->time() << " s");
        CHECK(model::find_crossings(surfaces, places).count == 0);
        const double motion = 0.2 * std::sin(M_PI * simulation->time());
        const auto [under, beside] = ends(state);
        // They are one bar: nothing tears the half that is stopped from the other one.
        CHECK(under == Approx(beside).margin(1e-6));
        CHECK(under < 0.1);
        // Without anything in the way, and again after it, a pin is where its motion is.
        if (motion < 0.08)
          CHECK(under == Approx(motion).margin(1e-6));
        else
          CHECK(under > 0.07);
        if (look == 3) CHECK(simulation->diagnose().surface_forced == 0);
      }
      CHECK(simulation->diagnose().surface_forced > 0);
    }
}
