// Under surface contact no vertex ends a step within a solid: neither where the filter cuts its way around
// one, nor where a push has bent its way, nor where a solid that moves comes upon it.
#include <algorithm>

#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "tests/catch.h"
#include "tests/contact_scenes.h"
#include "tests/physics/stage.h"
#include "tests/within_solids.h"

using namespace clothlab;
using glm::dvec3;

namespace {

std::uint64_t crossings(const sim::Simulation& simulation, const sim::State& state) {
  std::vector<dvec3> places(state.position.begin(), state.position.end());
  for (const dvec3& of_body : model::body_positions(simulation.model(), simulation.time()))
    places.emplace_back(glm::vec3(of_body));
  return model::find_crossings(model::surfaces_of(simulation.model()), places).count;
}

}  // namespace

TEST_CASE("under surface contact no vertex ends a step within a solid, at rest or moving") {
  struct Case {
    const char* scene;
    int size;
    double speed;  // [m/s]
    std::uint32_t steps;
  };
  const auto context = test::context();
  test::Part part(4);
  for (const Case& tried : {Case{"slot", 8, 50.0, 6}, {"layers", 9, 1.0, 25}, {"dropped_box", 8, 20.0, 10}})
    for (const char* method : {"implicit_euler", "xpbd", "vbd"}) {
      if (part.leaves_out()) continue;  // each scene, and each method, once
      INFO(tried.scene << " under " << method);
      const auto scenes = test::contact_scenes();
      const auto found =
          std::find_if(scenes.begin(), scenes.end(), [&](const auto& s) { return s.name == tried.scene; });
      test::ContactOptions options;
      options.size = tried.size;
      options.speed = tried.speed;
      options.method = method;
      options.kind = "surface";
      const auto document = scene::validate(found->document(options));
      REQUIRE(document);
      const auto simulation = test::simulation(document->scene);
      for (std::uint32_t step = 0; step < tried.steps; ++step) {
        simulation->step(1);
        const sim::State state = simulation->read_state();
        INFO("step " << step + 1);
        // The float32 position of a vertex, and where a solid is then: a few units in the last place at 1 m.
        CHECK(test::deepest_in_solids(*simulation, state) < 1e-6);
        CHECK(crossings(*simulation, state) == 0);
      }
    }
}

TEST_CASE("cloth that begins a step within a solid comes out of it without speed") {
  const auto context = test::context();
  const double dt = 0.001;
  test::Part part(5);
  for (const char* method :
       {"explicit_euler", "symplectic_euler", "verlet", "rk4", "implicit_euler", "pbd", "xpbd", "vbd"})
    for (const test::json& collider :
         {test::contact::floor(),
          test::contact::collider(
              "box", "box", {{"center", {0, -0.2, 0}}, {"half", {0.4, 0.2, 0.4}}, {"rotate", {0, 0, 0}}},
              {{"linear", {{"velocity", {1, 0, 0}}}}})}) {
      if (part.leaves_out()) continue;  // each family of methods, on a floor or a box that moves
      INFO(method << ", " << collider.dump());
      test::ContactOptions options;
      options.size = 6;
      options.method = method;
      options.dt = dt;
      test::json made = test::contact::scene_of(
          "within", options, {test::contact::sheet("sheet", 6, {0, -0.02, -0.25})}, {collider});
      made["self_collision"] = nullptr;
      made["colliders"][0]["friction"] = 0.0;
      const auto document = scene::validate(made);
      REQUIRE(document);
      const auto simulation = test::simulation(document->scene);
      simulation->step(1);
      const sim::State state = simulation->read_state();
      CHECK(test::deepest_in_solids(*simulation, state) < 1e-6);
      // It would be 20 m/s if the way out were one. Rounding: of 0.02 m by 2^-24, a few times, in a step.
      for (const glm::vec3& v : state.velocity) CHECK(glm::length(v) <= 9.8 * dt + 1e-5);
    }
}

TEST_CASE("a light layer between a solid that moves and heavy layers stays out of the solid") {
  const auto context = test::context();
  test::Part part(3);
  for (const char* method : {"symplectic_euler", "implicit_euler", "xpbd", "vbd"}) {
    if (part.leaves_out()) continue;  // a method that adds forces up, and one that sweeps
    INFO(method);
    test::ContactOptions options;
    options.size = 6;
    options.method = method;
    options.kind = "surface";
    std::vector<test::json> layers = test::contact::pile(options, 4, 0.02);
    for (int i = 1; i < 4; ++i) layers[i]["mass"] = {{"area_density", 100 * test::contact::density}};
    const test::json sphere = {{"center", {0, -1, 0}}, {"radius", 1.0}};
    const test::json motion = {{"linear", {{"velocity", {0, 10, 0}}}}};
    const auto document = scene::validate(test::contact::scene_of(
        "lifted", options, layers, {test::contact::collider("ball", "sphere", sphere, motion)}));
    REQUIRE(document);
    const auto simulation = test::simulation(document->scene);
    while (simulation->time() < 0.02) {
      simulation->step(1);
      const sim::State state = simulation->read_state();
      INFO(simulation->time() << " s");
      CHECK(test::deepest_in_solids(*simulation, state) < 1e-6);
      CHECK(crossings(*simulation, state) == 0);
    }
  }
}

TEST_CASE("a solid that presses cloth where it cannot go is told of, one that only pushes it is not") {
  const auto context = test::context();
  for (const bool floor : {true, false}) {
    INFO((floor ? "onto a floor" : "in free air"));
    test::ContactOptions options;
    options.size = 8;
    options.method = "xpbd";
    options.kind = "surface";
    const test::json sphere = {{"center", {0, 0.5, 0}}, {"radius", 0.15}};
    const test::json motion = {{"linear", {{"velocity", {0, -4, 0}}}}};
    std::vector<test::json> colliders = {test::contact::collider("ball", "sphere", sphere, motion)};
    if (floor) colliders.push_back(test::contact::floor());
    const auto document = scene::validate(
        test::contact::scene_of("press", options, test::contact::pile(options, 2, 0.06), colliders));
    REQUIRE(document);
    const auto simulation = test::simulation(document->scene);
    simulation->step(32);  // the ball's lowest point ends 16 cm below the floor
    CHECK((simulation->diagnose().surface_forced > 0) == floor);
  }
}

TEST_CASE(
    "cloth stays finite about a slanting bar that takes half a turn in a step: half-way it has no "
    "direction") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::document_of(R"({
    "version": 1, "name": "half turns", "gravity": [0, -9.8, 0],
    "cloths": [{"mesh": {"grid": {"columns": 9, "rows": 9, "width": 0.16, "height": 0.16}},
                "mass": {"per_vertex": 0.001}, "transform": {"translate": [0, 0.03, 0]},
                "material": {"structural": 100, "shear": 50, "bend": 10, "damping": 0.02}}],
    "colliders": [{"capsule": {"a": [-0.03, -0.04, 0], "b": [0.03, 0.04, 0], "radius": 0.02},
                   "motion": {"spin": {"axis": [0, 0, 1], "center": [0, 0, 0], "degrees_per_second": 360000}}}],
    "self_collision": {"thickness": 0.004, "friction": 0.3, "kind": "surface"},
    "solver": {"method": "symplectic_euler", "dt": 0.0005}})")
                                               .scene);
  simulation->step(50);
  CHECK(simulation->diagnose().finite);
}
