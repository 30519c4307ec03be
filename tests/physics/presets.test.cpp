// The presets that are about contact between layers go through nothing.
#include "tests/crossings.h"
#include "tests/scenes.h"

using namespace clothlab;

TEST_CASE("the presets of twisted, knotted, piled and worn cloth have no crossings when their layers meet") {
  struct Case {
    const char* preset;
    double time;  // [s], at which it had crossings under "points", with at least 0.7 spacings as thickness
  };
  const auto context = test::context();
  for (const Case& tried : {Case{"twist", 1.5},
                            {"knot", 0.4},
                            {"funnel", 0.5},
                            {"stack", 0.3},
                            {"mannequin", 0.49},
                            {"skirt", 4.5},
                            {"poncho", 0.56}}) {
    INFO(tried.preset);
    const scene::Scene scene = scene::load_preset(tried.preset)->scene;
    const auto simulation = test::simulation(scene);
    simulation->step(static_cast<std::uint32_t>(tried.time / scene.solver.dt + 0.5));
    CHECK(test::crossings(simulation->model(), simulation->read_state().position).empty());
  }
}
