// Every named fabric, as finite elements and as springs, is a cloth that hangs, and one that holds on a
// preset.
#include "server/scene/fabrics.h"

#include <algorithm>

#include "server/model/remedy.h"
#include "server/model/stability.h"
#include "server/sim/guarded_run.h"
#include "tests/scenes.h"

using namespace clothlab;
using nlohmann::json;

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

/// The preset with this fabric on each cloth, as the page's menu puts it there, and the solver that the
/// session gives it.
scene::Scene with_fabric(const std::string& preset, const std::string& fabric, const std::string& model) {
  const scene::Document loaded = *scene::load_preset(preset);
  json patch = json::array();
  for (std::size_t i = 0; i < loaded.scene.cloths.size(); ++i) {
    const std::string cloth = "/cloths/" + std::to_string(i);
    const json material{{"model", model}, {"fabric", fabric}};
    patch.push_back({{"op", "replace"}, {"path", cloth + "/material"}, {"value", material}});
    if (loaded.value["cloths"][i].contains("mass"))
      patch.push_back({{"op", "remove"}, {"path", cloth + "/mass"}});
  }
  scene::Scene scene = scene::apply_patch(loaded, patch)->scene;
  scene.solver = model::solver_that_holds(*model::build(scene), scene);
  return scene;
}

/// Runs the scene for a quarter of a second; false if it blows up.
bool holds(const scene::Scene& scene) {
  const auto simulation = test::simulation(scene);
  sim::GuardedRun guard(*simulation);
  guard.start(model::dt_limit(simulation->model(), scene));
  const auto steps = static_cast<std::uint32_t>(0.25 / scene.solver.dt + 0.5);
  const std::uint32_t look = sim::judged_every(scene, simulation->model());
  for (std::uint32_t done = 0; done < steps; done += look) {
    guard.step(std::min(look, steps - done));
    if (guard.judge_now() != sim::GuardedRun::Verdict::good) return false;
  }
  return true;
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

TEST_CASE("a fabric on a preset gives a cloth that holds, whichever is chosen on whichever") {
  const auto context = test::context();
  std::vector<std::string> presets{"drape"}, fabrics{"cotton", "silk", "denim", "tango"}, models{"springs"};
  if (test::thorough()) {
    presets = scene::preset_names();
    models = {"springs", "fem"};
    fabrics.clear();
    for (const scene::Fabric& fabric : *scene::fabrics()) fabrics.push_back(fabric.name);
  }
  for (const std::string& preset : presets)
    for (const std::string& fabric : fabrics)
      for (const std::string& model : models) {
        INFO(preset << ", " << fabric << " as " << model);
        CHECK(holds(with_fabric(preset, fabric, model)));
      }
}
