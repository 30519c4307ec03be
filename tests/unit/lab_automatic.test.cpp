// The method "auto": how a document asks for it, which method steps until the lab has chosen, and how long a
// choice holds.
#include <cmath>

#include "server/lab/measure/automatic.h"
#include "server/model/stability.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

scene::Document seed_with(const scene::json& patch) {
  const Result<scene::Document> changed = scene::apply_patch(*scene::load_preset("seed"), patch);
  if (!changed) FAIL(changed.error().text());
  return *changed;
}

const scene::json automatic{{"solver", {{"method", "auto"}, {"tolerance", 1e-2}}}};

}  // namespace

TEST_CASE("a scene with the method auto steps by verlet, stably, until something is chosen") {
  const scene::Document document = seed_with(automatic);
  CHECK(document.scene.solver.automatic);
  CHECK(document.value["solver"]["method"] == "auto");
  CHECK_FALSE(seed_with({{"solver", {{"method", "rk4"}}}}).scene.solver.automatic);
  const model::Model model = *model::build(document.scene);
  const lab::Setting setting = lab::provisional(model, document.scene);
  CHECK(setting.method == scene::Method::verlet);
  const double limit = model::dt_limit(model, lab::with(document.scene, setting));
  CHECK(setting.dt < 0.8 * limit);
  CHECK(setting.dt > 0.5 * limit);  // the bound that it comes from is never that far below
}

TEST_CASE("a document whose method auto is settled says so itself, and its scene is what it says") {
  const scene::Document document = *lab::with_provisional_setting(seed_with(automatic));
  CHECK_FALSE(document.scene.solver.automatic);
  CHECK(document.value["solver"]["method"] == "verlet");
  CHECK(document.scene == scene::validate(document.value)->scene);
  const scene::Document other = seed_with({{"solver", {{"method", "rk4"}}}});
  CHECK(*lab::with_provisional_setting(other) == other);
}

TEST_CASE("a choice holds while numbers stay within a tenth, and no longer") {
  const scene::json measured = seed_with(automatic).value;
  const auto after = [&](scene::json patch) {
    patch.merge_patch(automatic);
    return lab::covers(measured, seed_with(patch).value);
  };
  CHECK(after({}));
  CHECK(after({{"gravity", {0, -9.0, 0}}}));
  CHECK_FALSE(after({{"gravity", {0, -8.0, 0}}}));
  CHECK_FALSE(after({{"gravity", {0.1, -9.8, 0}}}));  // a change from 0 is never small
  CHECK(after({{"name", "another"}}));
  CHECK_FALSE(after({{"self_collision", nullptr}}));
  CHECK_FALSE(after({{"air_drag", 0.5}}));
  CHECK_FALSE(
      lab::covers(measured, seed_with({{"solver", {{"method", "auto"}, {"tolerance", 1e-3}}}}).value));
  CHECK_FALSE(
      lab::covers(measured, seed_with({{"solver", {{"method", "verlet"}, {"tolerance", 1e-2}}}}).value));
}
