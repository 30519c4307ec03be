// The lab's verdict on leaving parts of a scene out.
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/simplified.h"

using namespace clothlab;
using namespace clothlab::test;
using lab::Simplification;
using lab::Variant;

namespace {

/// A cloth pulled a little in its plane; it swings by less than a thousandth and never touches itself.
scene::Document pulled(const std::string& material, const std::string& more,
                       const std::string& gravity = "[0, 0, 0.5]", const std::string& mass = "0.001") {
  return document_of(R"({"version": 1, "name": "pulled", "gravity": )" + gravity +
                     R"(, "cloths": [{"mesh": {"grid": {"columns": 33, "rows": 33, "width": 1, "height": 1}},
                "mass": {"per_vertex": )" +
                     mass + R"(}, "material": )" + material + R"(, "pins": [{"at": "edge:row:0"}]}])" + more +
                     "}");
}

}  // namespace

TEST_CASE("a flat pulled sheet needs neither bend springs nor self-collision nor its fine mesh") {
  const auto context = test::context();
  const scene::Document whole =
      pulled(R"({"structural": 200, "shear": 100, "bend": 50, "damping": 0.01})",
             R"(, "self_collision": {"thickness": 0.01}, "solver": {"dt": 0.0005})");
  // What a simulated second costs: steps times vertices, and as much again for self-collision.
  lab::SimplifyRequest request{1e-2, 0.3};
  request.timer = [](const scene::Scene& scene) {
    const auto& grid = std::get<scene::Grid>(scene.cloths[0].mesh);
    return grid.columns * grid.rows / scene.solver.dt * (scene.self_collision ? 2.0 : 1.0);
  };
  const Simplification result = simplified(whole, request);
  REQUIRE(result.whole.measured);
  for (const char* name : {"without bend springs", "without self-collision", "half the mesh resolution"}) {
    INFO(name);
    const Variant& part = variant(result, name);
    REQUIRE(part.measured);
    REQUIRE(part.change);
    // The pull stretches it by g M / (2 k) = 1.4 mm at most; no part changes it by more.
    CHECK(*part.change < 2e-3);
    CHECK(part.error[lab::index(lab::Axis::position)]);
  }
  CHECK(variant(result, "without bend springs").cost_ratio.median == 1.0);
  CHECK_FALSE(variant(result, "without bend springs").recommended_to_drop);
  CHECK(variant(result, "without self-collision").cost_ratio.median == 0.5);
  CHECK(*variant(result, "without self-collision").change < 1e-7);
  const Variant& half = variant(result, "half the mesh resolution");
  const Variant& quarter = variant(result, "a quarter of the mesh resolution");
  // 17 x 17 and 9 x 9 vertices of 33 x 33, and their own steps.
  const double dt_of_half = half.patch["solver"]["dt"], dt_of_quarter = quarter.patch["solver"]["dt"];
  CHECK(half.cost_ratio.median == Approx(289.0 / 1089.0 * 0.0005 / dt_of_half));
  CHECK(quarter.cost_ratio.median == Approx(81.0 / 1089.0 * 0.0005 / dt_of_quarter));
  CHECK(quarter.recommended_to_drop);
  CHECK_FALSE(half.recommended_to_drop);
  // The step keeps its share of the limit, which is twice as long on cells twice as wide, except for the
  // edges.
  CHECK(dt_of_half / half.dt_limit == Approx(0.0005 / result.whole.dt_limit).epsilon(1e-9));
  CHECK(half.dt_limit / result.whole.dt_limit == Approx(2.0).epsilon(0.05));
  REQUIRE(result.recommended.recommended_to_drop);
  CHECK(*result.recommended.change <= result.tolerance);
  CHECK(result.recommended.cost_ratio.median == Approx(0.5 * quarter.cost_ratio.median));
  const auto patched = scene::apply_patch(whole, result.recommended.patch);
  REQUIRE(patched);
  CHECK_FALSE(patched->scene.self_collision);
  CHECK(std::get<scene::Grid>(patched->scene.cloths[0].mesh).columns == 9);
}

TEST_CASE("where surfaces keep apart, the lab says if points, or nothing, would do") {
  const auto context = test::context();
  const auto costs = [](const scene::Scene& scene) {
    if (!scene.self_collision) return 1.0;
    return scene.collides(scene::ContactKind::surface) ? 8.0 : 2.0;
  };
  const char* const points = "with points that keep apart instead of surfaces";
  const scene::Document flat =
      pulled(R"({"structural": 200, "shear": 100, "bend": 50, "damping": 0.01})",
             R"(, "self_collision": {"thickness": 0.01, "kind": "surface"}, "solver": {"dt": 0.0005})");
  const Simplification apart = simplified(flat, {1e-2, 0.1, costs});
  CHECK(apart.why.find("Points suffice here: ") != std::string::npos);
  CHECK(apart.why.find("Doing without self-collision suffices here: ") != std::string::npos);
  CHECK(variant(apart, points).cost_ratio.median == 0.25);
  // Only one of the two can be taken: that which saves more.
  CHECK(apart.recommended.patch["self_collision"].is_null());
  CHECK_FALSE(variant(apart, points).recommended_to_drop);

  // Two sheets, one falling on the middle of the other's large cells: points pass between points.
  const scene::Document falling = document_of(R"({"version": 1, "name": "falling",
    "cloths": [{"mesh": {"grid": {"columns": 5, "rows": 5, "width": 0.4, "height": 0.4}},
                "mass": {"per_vertex": 0.001}, "material": {"structural": 200, "shear": 100, "bend": 50, "damping": 0.01},
                "pins": [{"at": "edge:row:0"}, {"at": "edge:row:4"}]},
               {"mesh": {"grid": {"columns": 3, "rows": 3, "width": 0.04, "height": 0.04}},
                "transform": {"translate": [0.05, 0.01, 0.17]}, "mass": {"per_vertex": 0.001},
                "material": {"structural": 200, "shear": 100, "bend": 50, "damping": 0.01}}],
    "self_collision": {"thickness": 0.005, "kind": "surface"}, "solver": {"dt": 0.0005}})");
  const Simplification met = simplified(falling, {1e-2, 0.3, costs});
  CHECK(met.why.find("Points do not suffice here: ") != std::string::npos);
  CHECK(met.why.find("Doing without self-collision does not suffice here: ") != std::string::npos);
}

namespace {

/// Parts that change nothing here, with timings made up from what each is said to save.
Simplification with_savings(double bend, double self_collision, double both, double noise) {
  const scene::Document whole =
      pulled(R"({"structural": 200, "shear": 100, "bend": 50, "damping": 0.01})",
             R"(, "self_collision": {"thickness": 0.01}, "solver": {"dt": 0.0005})");
  std::mt19937 random(1);
  lab::SimplifyRequest request{1e-2, 0.1};
  request.timer = [=](const scene::Scene& scene) mutable {
    const bool bends = scene.cloths[0].springs().bend > 0.0, collides = scene.self_collision.has_value();
    const double cost = bends ? (collides ? 1.0 : self_collision) : collides ? bend : both;
    return cost * std::max(0.1, 1.0 + noise * std::normal_distribution<>()(random));
  };
  return simplified(whole, request);
}

}  // namespace

TEST_CASE("parts that save nothing are not recommended, however noisy the machine is") {
  const auto context = test::context();
  for (const double noise : {0.0, 0.1, 0.3}) {
    INFO(noise);
    const Simplification result = with_savings(1.0, 1.0, 1.0, noise);
    CHECK_FALSE(result.recommended.recommended_to_drop);
    CHECK(result.recommended.patch.empty());
    for (const Variant& part : result.variants) CHECK_FALSE(part.recommended_to_drop);
    if (noise > 0.2) CHECK(result.why.find("cannot tell") != std::string::npos);
    if (noise == 0.0) CHECK(result.why.find("saves less than 5 %") != std::string::npos);
  }
}

TEST_CASE("a combination is recommended only where it costs less than its best part") {
  const auto context = test::context();
  // the two together cost more than one alone
  const Simplification best = with_savings(0.8, 0.6, 0.62, 0.03);
  CHECK(best.recommended.name == "without self-collision");
  CHECK_FALSE(best.drops_several());
  CHECK_FALSE(variant(best, "without bend springs").recommended_to_drop);
  CHECK(std::any_of(best.notes.begin(), best.notes.end(), [](const std::string& note) {
    return note.find("\"without bend springs\" is not recommended in addition") != std::string::npos;
  }));
  const Simplification both = with_savings(0.8, 0.6, 0.45, 0.03);
  CHECK(both.recommended.name == "without self-collision and without bend springs");
  CHECK(both.drops_several());
  CHECK(variant(both, "without bend springs").recommended_to_drop);
  CHECK(both.recommended.cost_ratio.median == Approx(0.45).epsilon(0.05));
}

TEST_CASE("parts that a scene does not have are not measured, and parts that change too much stay") {
  const auto context = test::context();
  const Simplification result = simplified(*scene::load_preset("hanging-strip"), {1e-4, 0.3});
  const Variant& bend = variant(result, "without bend springs");
  CHECK_FALSE(bend.measured);
  CHECK(bend.reason == "the scene has no bend springs");
  const Variant& half = variant(result, "half the mesh resolution");
  CHECK(half.measured);
  CHECK(*half.change > 1e-4);
  CHECK_FALSE(half.recommended_to_drop);
  CHECK_FALSE(result.recommended.recommended_to_drop);
  CHECK(result.recommended.patch.empty());
  CHECK(result.why.starts_with("Nothing "));
}

TEST_CASE("a scene that blows up as it is gets no advice but a stable step") {
  const auto context = test::context();
  const Result<Simplification> result = lab::simplify(*scene::load_preset("blowup"), {1e-2, 0.3}, {});
  REQUIRE(result);
  CHECK_FALSE(result->whole.measured);
  CHECK(result->whole.reason.starts_with("it blew up at"));
  CHECK(result->variants.empty());
  CHECK(result->why.find("stable step") != std::string::npos);
}

TEST_CASE("without a reference what parts change is still measured, and errors are not made up") {
  const auto context = test::context();
  // It falls, and is so stiff and light that rounding is more than its weight: no step of the reference is
  // solved.
  const scene::Document stiff =
      pulled(R"({"structural": 1e12, "shear": 1e12, "bend": 1e12, "damping": 0})",
             R"(, "solver": {"method": "xpbd", "dt": 0.005, "iterations": 5})", "[0, -9.8, 0]", "1e-9");
  // (What it costs is not asked for.)
  const Simplification result = simplified(stiff, {1e-2, 0.2, [](const scene::Scene&) { return 1.0; }});
  CHECK(result.whole.measured);
  CHECK_FALSE(result.whole.error[lab::index(lab::Axis::position)]);
  CHECK(std::any_of(result.notes.begin(), result.notes.end(),
                    [](const std::string& note) { return note.starts_with("There is no reference"); }));
  CHECK(variant(result, "without bend springs").change);
}

TEST_CASE("a cancelled simplification begins nothing more, and a wrong tolerance is refused") {
  const auto context = test::context();
  std::stop_source source;
  int begun_after = 0;
  lab::Control<Simplification> control;
  control.stop = source.get_token();
  control.progress = [&](const lab::Progress& progress) {
    if (source.stop_requested()) ++begun_after;
    if (progress.doing == "timing, taking turns") source.request_stop();
  };
  const auto result = lab::simplify(*scene::load_preset("hanging-strip"), {1e-2, 0.2}, control);
  REQUIRE_FALSE(result);
  CHECK(lab::was_cancelled(result.error()));
  CHECK(begun_after == 0);
  CHECK(lab::simplify(*scene::load_preset("seed"), {0.0, {}}, {}).error().where == "tolerance");
  CHECK(lab::simplify(*scene::load_preset("seed"), {0.1, -1.0}, {}).error().where == "time");
}
