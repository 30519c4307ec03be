// Every named fabric, as finite elements and as springs, is a cloth that hangs.
#include "server/scene/fabrics.h"

#include "server/model/stability.h"
#include "server/sim/guarded_run.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

/// A square of 0.5 m, hung by two corners, under implicit Euler.
scene::Scene hung(const std::string& fabric, const std::string& model) {
  return test::document_of(R"({"version": 1, "cloths": [{
      "mesh": {"grid": {"columns": 9, "rows": 9, "width": 0.5, "height": 0.5}},
      "material": {"model": ")" +
                           model + R"(", "fabric": ")" + fabric + R"("},
      "pins": [{"at": "corner:0,0"}, {"at": "corner:8,0"}]}],
      "solver": {"method": "implicit_euler", "dt": 0.01, "iterations": 3}})")
      .scene;
}

}  // namespace

TEST_CASE(
    "every fabric hangs for 0.2 s without a blow-up and falls by less than a free body, in both models") {
  const auto context = test::context();
  for (const scene::Fabric& fabric : *scene::fabrics())
    for (const char* model : {"fem", "springs"}) {
      INFO(fabric.name << ", " << model);
      const auto simulation = test::simulation(hung(fabric.name, model));
      sim::GuardedRun guard(*simulation);
      guard.start(model::dt_limit(simulation->model(), simulation->scene()));
      guard.step(20);
      CHECK(guard.judge_now() == sim::GuardedRun::Verdict::good);
      const sim::State state = simulation->read_state();
      // The middle swings about the pinned edge: never below free fall, and by more than half of it.
      const double fall = simulation->model().rest_position[40].y - state.position[40].y;
      CHECK(fall < 0.5 * 9.8 * 0.2 * 0.21);
      CHECK(fall > 0.25 * 9.8 * 0.2 * 0.2);
    }
}
