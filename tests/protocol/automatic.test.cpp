// The method "auto" in a session, without its threads: when a choice is due, and what a choice changes.
#include "server/session/automatic.h"

#include "tests/catch.h"

using namespace clothlab;
using session::Automatic;

namespace {

scene::Document seed_with(const scene::json& patch = scene::json::object()) {
  scene::json whole{{"solver", {{"method", "auto"}, {"tolerance", 1e-2}}}};
  whole.merge_patch(patch);
  const Result<scene::Document> changed = scene::apply_patch(*scene::load_preset("seed"), whole);
  if (!changed) FAIL(changed.error().text());
  return *changed;
}

lab::Choice choice_of(const lab::Setting& setting) {
  lab::Choice choice;
  choice.met = true;
  choice.chosen.setting = setting;
  choice.chosen.largest_position_error = 4e-3;
  choice.why = "because";
  return choice;
}

scene::Method stepped(Automatic& automatic, const scene::Document& document,
                      Automatic::Clock::time_point now) {
  const Result<scene::Scene> scene = automatic.settle(document, now);
  REQUIRE(scene);
  return scene->solver.method;
}

}  // namespace

TEST_CASE("a choice is due once, when the scene has been left alone for a while") {
  Automatic automatic;
  const Automatic::Clock::time_point start{};
  CHECK(stepped(automatic, seed_with(), start) == scene::Method::verlet);
  CHECK_FALSE(automatic.wants_choice(start + Automatic::quiet / 2));
  REQUIRE(automatic.settle(seed_with({{"air_drag", 1}}), start + Automatic::quiet / 2));
  CHECK_FALSE(automatic.wants_choice(start + Automatic::quiet));
  CHECK(automatic.wants_choice(start + 2 * Automatic::quiet));
  CHECK_FALSE(automatic.wants_choice(start + 3 * Automatic::quiet));
  CHECK(automatic.facts()["state"] == "measuring");
}

TEST_CASE("the chosen method steps as long as it covers the scene, and without a choice a stable one does") {
  Automatic automatic;
  const Automatic::Clock::time_point now{};
  const lab::Setting rk4{scene::Method::rk4, 2e-3, 1, 1e-4};
  automatic.take(seed_with(), choice_of(rk4));
  const Result<scene::Scene> scene = automatic.settle(seed_with({{"gravity", {0, -9.5, 0}}}), now);
  REQUIRE(scene);
  CHECK(lab::setting_of(*scene) == rk4);
  CHECK(automatic.facts()["why"] == "because");
  CHECK_FALSE(automatic.wants_choice(now + 2 * Automatic::quiet));

  const scene::Document another = seed_with({{"gravity", {0, -5, 0}}});
  CHECK(stepped(automatic, another, now) == scene::Method::verlet);
  CHECK(automatic.wants_choice(now + Automatic::quiet));

  // No choice was found for this document: it is not asked for again before something changes.
  automatic.take(another, Error{"choose", "chaotic", "the chart"});
  REQUIRE(automatic.settle(another, now));
  CHECK(automatic.facts()["state"] == "failed");
  CHECK_FALSE(automatic.wants_choice(now + 2 * Automatic::quiet));

  CHECK(stepped(automatic, seed_with({{"solver", {{"method", "xpbd"}}}}), now) == scene::Method::xpbd);
  CHECK(automatic.facts().is_null());
}
