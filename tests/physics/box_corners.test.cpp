// Under the self-collision kind `surface`, whose thickness may be much less than an edge, cloth must not
// catch on the corners of a box, which would cut an edge between two vertices that the solid keeps out.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/sim/colliders.h"
#include "server/sim/crossing_check.h"
#include "server/sim/simulation.h"
#include "tests/catch.h"
#include "tests/contact_scenes.h"
#include "tests/physics/stage.h"

using namespace clothlab;
using glm::dvec3;

namespace {

/// A sheet that lies on a table with one half and hangs over its end with the other; its edge on the table is
/// drawn away by 0.2 m within a second.
scene::Scene over_the_end(const std::string& method) {
  return scene_of(R"({"version": 1,
    "cloths": [{"mesh": {"grid": {"columns": 13, "rows": 13, "width": 0.36, "height": 0.36}},
                "transform": {"translate": [0, 0.02, -0.18]},
                "mass": {"area_density": 0.15},
                "material": {"structural": 300, "shear": 150, "bend": 20, "damping": 0.02},
                "pins": [{"at": "edge:column:0",
                          "motion": {"oscillate": {"axis": [-1, 0, 0], "amplitude": 0.2, "frequency": 0.25}}}]}],
    "colliders": [{"box": {"center": [-0.4, -0.5, 0], "half": [0.4, 0.5, 0.4]}, "friction": 0.2}],
    "self_collision": {"kind": "surface", "thickness": 0.008, "friction": 0.2},
    "solver": {"method": ")" +
                  method + R"(", "dt": 0.002, "iterations": 5}})");
}

/// Steps of `scene` that make 0.05 s. The explicit method cannot step by 2 ms: its limit is 0.3 ms.
std::uint32_t step_stably(scene::Scene& scene) {
  if (!scene::iterates(scene.solver.method)) scene.solver.dt = 0.0002;
  return static_cast<std::uint32_t>(std::lround(0.05 / scene.solver.dt));
}

/// How deep a point is within a box along the axes [m]; negative outside.
double depth(const scene::Box& box, const dvec3& point) {
  const dvec3 within = box.half - glm::abs(point - box.center);
  return std::min({within.x, within.y, within.z});
}

double longest_edge(const model::Model& model, const std::vector<glm::vec3>& place) {
  double longest = 0.0;
  for (const auto& corners : model.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max<double>(longest, glm::distance(place[corners[k]], place[corners[(k + 1) % 3]]));
  return longest;
}

/// The most that any point of the triangles' sides is within the box [m].
double deepest(const model::Model& model, const std::vector<glm::vec3>& place, const scene::Box& box) {
  double most = -1.0;
  for (const auto& corners : model.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      for (int share = 0; share <= 16; ++share)
        most = std::max(most, depth(box, glm::mix(dvec3(place[corners[k]]),
                                                  dvec3(place[corners[(k + 1) % 3]]), share / 16.0)));
  return most;
}

}  // namespace

TEST_CASE("cloth that is drawn over the end of a table does not catch on it", "[physics][surface]") {
  const auto context = test::context();
  test::Part part(3);
  for (const char* method : {"symplectic_euler", "vbd"})
    for (const bool moves : {false, true}) {
      if (part.leaves_out()) continue;  // each method, and each table
      INFO(method << (moves ? ", a table that could move" : ""));
      scene::Scene scene = over_the_end(method);
      const std::uint32_t steps = step_stably(scene);
      if (moves) scene.colliders[0].motion = scene::Linear{};
      auto simulation = test::simulation(scene);
      const model::Model& model = simulation->model();
      const auto& box = std::get<scene::Box>(scene.colliders[0].shape);
      const double margin = sim::contact_margin(scene, model, 0, scene.colliders[0]);
      CHECK((margin > sim::contact_margin(scene, model, 0)) == moves);
      for (int part = 0; part < 20; ++part) {
        simulation->step(steps);
        const std::vector<glm::vec3> place = simulation->read_state().position;
        // At rest its edges keep the cloth out, to rounding. One that moves keeps vertices away: an edge
        // whose ends are as far from both faces as the margin reaches half of its length less sqrt(2) margins
        // beyond the corner; the margin is for the mean edge, and diagonals are longer.
        const double may = moves ? longest_edge(model, place) / 2.0 - std::sqrt(2.0) * margin : 0.0;
        CHECK(deepest(model, place, box) < std::max(may, 1e-5));
      }
      // Its weight, 0.2 N, and friction stretch 12 threads by 0.3 %; the impact where it falls on the table
      // by more. A cloth that is caught is stretched by half of its length.
      CHECK(simulation->diagnose().max_strain < 0.1);
    }
}

TEST_CASE("cloth drawn into a narrow slot between boxes goes through neither itself nor them",
          "[physics][surface]") {
  const auto context = test::context();
  const auto scenes = test::contact_scenes();
  const auto slot =
      std::find_if(scenes.begin(), scenes.end(), [](const auto& of) { return of.name == "slot"; });
  for (const std::string method : {"implicit_euler", "vbd"}) {
    if (method != "vbd" && !test::thorough()) continue;
    INFO(method);
    test::ContactOptions options;
    options.kind = "surface";
    options.method = method;
    const scene::Scene scene = scene::validate(slot->document(options))->scene;
    auto simulation = test::simulation(scene);
    sim::CrossingCheck check(*simulation);
    nlohmann::ordered_json report;
    for (int frame = 0; frame < 24; ++frame) {  // 0.77 s: down, and some way up again
      simulation->step(8);
      check.add(simulation->read_state(), simulation->time());
    }
    check.report(report);
    CHECK(report["crossings"] == 0);
    // What catches is stretched to many times its length; drawn tight over both rims it is stretched by less.
    CHECK(simulation->diagnose().max_strain < 1.0);
  }
}

TEST_CASE("a table that is put elsewhere under cloth takes it along, whole", "[physics][surface]") {
  const auto context = test::context();
  scene::Scene scene = over_the_end("vbd");
  scene.self_collision->kind = scene::ContactKind::points;  // its corners come while the simulation runs
  scene.cloths[0].pins.clear();
  auto simulation = test::simulation(scene);
  simulation->step(100);
  scene.self_collision->kind = scene::ContactKind::surface;
  CHECK(*simulation->change(scene) == sim::ChangeDepth::kernel);
  simulation->step(50);
  // 3 cm higher, and 5 cm further: its rim, and the cloth on it, are within each other.
  std::get<scene::Box>(scene.colliders[0].shape).center += dvec3(0.05, 0.03, 0.0);
  CHECK(*simulation->change(scene) == sim::ChangeDepth::uniform);
  simulation->step(500);
  const sim::State state = simulation->read_state();
  sim::CrossingCheck check(*simulation);
  check.add(state, simulation->time());
  nlohmann::ordered_json report;
  check.report(report);
  INFO(check.in_words());
  CHECK(report["crossings"] == 0);
  CHECK(simulation->diagnose().max_strain < 0.1);
  const auto& box = std::get<scene::Box>(scene.colliders[0].shape);
  for (const glm::vec3& place : state.position) CHECK(depth(box, place) < 1e-5);
}
