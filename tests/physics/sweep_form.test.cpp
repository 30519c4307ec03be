// Which of the two forms of a sweep a cloth gets (server/sim/sweep_form.h).
#include <cstdlib>

#include "server/sim/sweep_form.h"
#include "tests/catch.h"
#include "tests/scenes.h"

using namespace clothlab;

TEST_CASE("a cloth is swept in the form that was measured to be the faster one on this device") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::xpbd, scene::Method::vbd}) {
    const double even = sim::vertices_a_dispatch(method == scene::Method::vbd);
    CHECK(even >= 0.0);
    for (const int side : {3, 12, 24, 40}) {
      scene::Scene scene;
      scene.cloths.resize(1);
      scene.cloths[0].mesh = scene::Grid{side, side, 0.5, 0.5};
      scene.solver = {.method = method, .dt = 1e-3, .iterations = 1};
      const auto dispatches = [&] {
        const auto simulation = test::simulation(scene);
        simulation->step(1);
        return simulation->dispatches();
      };
      setenv("CLOTHLAB_SWEEPS", "dispatches", 1);
      const std::uint64_t many = dispatches();
      unsetenv("CLOTHLAB_SWEEPS");
      // Besides a sweep's, many dispatches are two, and a third one where sweeps visit vertices.
      const double of_sweep = static_cast<double>(many) - (method == scene::Method::vbd ? 3 : 2);
      INFO(scene::name(method) << ", " << side << " vertices a side, even at " << even);
      CHECK((dispatches() == 1) == (side * side <= even * of_sweep));
    }
  }
}
