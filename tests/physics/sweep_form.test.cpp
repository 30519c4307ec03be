// Which of the two forms of a sweep a cloth gets (server/sim/sweep_form.h), and that cloths of all sizes
// share the kernels of a form.
#include "server/sim/sweep_form.h"

#include <cstdlib>

#include "server/sim/coloured_work.h"
#include "server/sim/conjugate_gradients.h"
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

TEST_CASE(
    "a cloth that gets another size, as from a slider, needs no kernel that is compiled for that size") {
  const auto context = test::context();
  scene::Scene small = test::sheet(9, 9), large = test::sheet(11, 10);
  const model::Model first = *model::build(small), second = *model::build(large);
  CHECK(sim::visit_defines(sim::visited_elements(first, small), true) ==
        sim::visit_defines(sim::visited_elements(second, large), true));
  CHECK(sim::visit_defines(sim::visited_vertices(first, small), false) ==
        sim::visit_defines(sim::visited_vertices(second, large), false));
  CHECK(sim::ConjugateGradients(first).defines() == sim::ConjugateGradients(second).defines());
  CHECK(sim::step_defines(sim::plan(small)) == sim::step_defines(sim::plan(large)));
  CHECK(sim::vertex_room(81, false) == sim::vertex_room(110, false));
}

TEST_CASE("a cloth without a free vertex steps in both forms, where a sweep visits nothing") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::pbd, scene::Method::xpbd, scene::Method::vbd})
    for (const char* form : {"one_group", "dispatches"}) {
      INFO(scene::name(method) << ", " << form);
      scene::Scene scene = test::sheet(2, 2);
      scene.solver = {.method = method, .dt = 1e-3, .iterations = 2};
      scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}},
                              {scene::AtEdge{scene::AtEdge::Line::row, 1}, {}}};
      setenv("CLOTHLAB_SWEEPS", form, 1);
      const auto simulation = test::simulation(scene);
      unsetenv("CLOTHLAB_SWEEPS");
      const auto before = simulation->read_state().position;
      simulation->step(2);
      CHECK(simulation->read_state().position == before);
    }
}

TEST_CASE("a work group has room for its cloth, and for no more vertices than its shared memory holds") {
  const auto context = test::context();
  GLint bytes = 0;
  glGetIntegerv(GL_MAX_COMPUTE_SHARED_MEMORY_SIZE, &bytes);
  for (const bool self_collision : {false, true}) {
    const auto most = static_cast<std::uint32_t>(bytes) / (self_collision ? 32 : 16);
    for (const std::uint32_t vertices : {1U, 64U, 65U, 1000U, most - 1, most}) {
      CHECK(sim::vertex_room(vertices, self_collision) >= vertices);
      CHECK(sim::vertex_room(vertices, self_collision) <= most);
    }
  }
}
