// Under surface contact no vertex ends a step within a solid: neither where the filter cuts its way around
// one, nor where a push has bent its way, nor where a solid that moves comes upon it.
#include <catch2/catch.hpp>

#include <algorithm>

#include "server/model/bodies.h"
#include "server/model/crossings.h"
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
  for (const Case& tried : {Case{"slot", 8, 50.0, 6}, {"layers", 9, 1.0, 25}, {"dropped_box", 8, 20.0, 10}})
    for (const char* method : {"implicit_euler", "xpbd", "vbd"}) {
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
