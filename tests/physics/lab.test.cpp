// The lab's truth, chart and choice, mostly on the swinging cloth, whose errors are known (tests/README.md).
#include <algorithm>
#include <cmath>

#include "server/base/text.h"
#include "server/lab/measure/choice.h"
#include "server/lab/measure/control.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"
#include "server/lab/measure/whole_time.h"
#include "server/reference/follower.h"
#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/physics/stage.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::lab;
using scene::Method;

namespace {

scene::Scene swinging(Method method = Method::symplectic_euler) {
  scene::Scene scene = test::swinging_cloth(method, 0.6 * test::cloth_unit);
  scene.cloths[0].transform.translate = {0.0, 1.0, 0.0};  // an offset that would show in the energy
  return scene;
}

Truth truth_of(const scene::Scene& scene, TruthRequest request) {
  Result<Truth> found = truth(scene, request, {}, [](double) {});
  if (!found) FAIL(found.error().text());
  return *found;
}

Chart chart_of(const scene::Scene& scene, const ChartRequest& request) {
  Result<Chart> made = chart(scene, request, {});
  if (!made) FAIL(made.error().text());
  return *made;
}

std::vector<Point> points_of(const Chart& chart, Method method) {
  std::vector<Point> points;
  for (const Point& point : chart.points)
    if (point.setting.method == method && point.error[index(Axis::position)]) points.push_back(point);
  return points;
}

/// Order between two points: slope of error over dt in the log-log plane.
double order(const Point& a, const Point& b) {
  return std::log(*a.error[index(Axis::position)] / *b.error[index(Axis::position)]) /
         std::log(a.setting.dt / b.setting.dt);
}

}  // namespace

TEST_CASE("the lab's steps meet many samples, are no longer than asked for, and stay what they are") {
  Truth truth;
  truth.spacing = 0.3 / samples_to_horizon;
  for (double dt = 0.2; dt > 1e-5; dt /= 1.037) {
    const int steps = steps_to_horizon(dt, truth);
    const double fitted = fitted_dt(dt, truth);
    CAPTURE(dt, steps);
    CHECK(fitted <= dt * (1 + 2e-5));
    CHECK(steps % 4 == 0);
    CHECK(steps <= std::max(1.04 * std::ceil(0.3 / dt) + 1, std::ceil(0.3 / dt) + 3));
    CHECK(std::abs(fitted * steps - 0.3) < 2e-6);
    CHECK(steps_to_horizon(fitted, truth) == steps);
    if (steps >= 1600) CHECK(steps % samples_to_horizon == 0);
  }
}

TEST_CASE("the lab's reference of the swinging cloth is as exact as it says, for the whole time") {
  const Truth found = truth_of(swinging(), {0.3, 1e-7, 30.0});
  CHECK(found.why_no_reference.empty());
  CHECK(found.horizon == 0.3);  // it buckles at 0.5 s
  REQUIRE(found.position.size() == samples_to_horizon);
  const auto exact = reference::trajectory(found.world, {0.3}, test::cloth_unit / 50);
  REQUIRE(exact);
  const double off = reference::rms_distance(found.position.back(), exact->states[0].position);
  // The estimate is within a factor of three of the error, and as small as was asked for.
  CHECK(off < 3.0 * found.position_error);
  CHECK(found.position_error < 1e-7 * found.size);
}

TEST_CASE("a coarse reference is told once, before the steps are halved further, and can end the work") {
  std::vector<Truth> told;
  TruthRequest request{0.3, 1e-8, 30.0};  // RK4's longest steps have an error of 1e-7
  request.early = [&](const Truth& coarse) {
    told.push_back(coarse);
    return ok();
  };
  const Truth found = truth_of(swinging(), request);
  REQUIRE(told.size() == 1);
  REQUIRE(told[0].position.size() == samples_to_horizon);
  CHECK(told[0].position_error > found.position_error);
  // Its estimate is within a factor of three of the error.
  CHECK(reference::rms_distance(told[0].position.back(), found.position.back()) <
        3.0 * told[0].position_error);
  CHECK(told[0].energy.size() == found.energy.size());

  request.early = [](const Truth&) -> Status { return cancelled; };
  const Result<Truth> ended = truth(swinging(), request, {}, [](double) {});
  REQUIRE(!ended);
  CHECK(was_cancelled(ended.error()));
}

TEST_CASE("a horizon ends where a cloth buckles, and a tangle has none: the lab says why") {
  const Truth buckling = truth_of(swinging(), {1.0, 1e-5, 30.0});
  CHECK(buckling.horizon > 0.3);
  CHECK(buckling.horizon < 1.0);
  CHECK(buckling.horizon_reason.find("100 times") != std::string::npos);

  // A tangle departs from its copy within 0.2 s: too early for a request of ten seconds.
  scene::Scene tangle = swinging();
  tangle.cloths[0].mesh = scene::Grid{7, 7, 0.5, 0.5};
  tangle.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}};
  tangle.cloths[0].start = scene::Scatter{0.5, 1};
  const Truth lost = truth_of(tangle, {10.0, 1e-5, 60.0});
  CHECK(lost.horizon == 0.0);
  CHECK(lost.position.empty());
  CHECK(lost.energy.size() == samples_to_horizon);
  CHECK(lost.horizon_reason.find("chaotic at once") != std::string::npos);
}

TEST_CASE("the reference ends where surfaces touch, of which it knows no contact, and says what touches") {
  constexpr double height = 0.1, thickness = 0.004, asked = 0.3;
  const auto above_a_plate = [&](double of) {
    return test::document_of(
               formatted(
                   R"({"version":1,"cloths":[{"mesh":{"grid":{"columns":3,"rows":3,"width":0.2,"height":0.2}},
            "transform":{"translate":[0,%g,-0.1]},"mass":{"per_vertex":0.001},
            "material":{"structural":10,"shear":5,"bend":1}}],
            "colliders":[{"mesh":{"vertices":[[-1,0,-1],[1,0,-1],[1,0,1],[-1,0,1]],
                                  "triangles":[[0,2,1],[0,3,2]]}}],
            "self_collision":{"kind":"surface","thickness":%g}})",
                   of, thickness))
        .scene;
  };
  const Truth falling = truth_of(above_a_plate(height), {asked, 1e-5, 30.0});
  const double touches = std::sqrt(2.0 * (height - thickness) / 9.8);
  INFO(falling.horizon_reason);
  CHECK(falling.time < touches);
  CHECK(falling.time > touches - 2.0 * asked / 128);  // the last look of 128 before, and the one before that
  CHECK(falling.horizon == falling.time);
  CHECK(falling.horizon_reason.find("of the 0.3 s asked for") != std::string::npos);
  CHECK(falling.horizon_reason.find("/colliders/0") != std::string::npos);

  const Truth resting = truth_of(above_a_plate(0.8 * thickness), {asked, 1e-5, 30.0});
  CHECK(resting.why_no_reference.find("no contact between surfaces") != std::string::npos);
}

TEST_CASE("beyond a horizon a setting has to keep what is known without a reference") {
  const auto context = test::context();
  scene::Scene cotton =
      test::document_of(
          R"({"version":1,"cloths":[{"mesh":{"grid":{"columns":13,"rows":13}},"material":{"fabric":"cotton"},
          "pins":[{"at":"corner:0,0"},{"at":"corner:12,0"}]}]})")
          .scene;
  Truth known;
  Result<reference::World> world = reference::make_world(cotton, {0.0});
  REQUIRE(world);
  known.world = std::move(*world);
  known.size = 1.0;
  known.asked = 0.5;
  TrialRunner trials;
  WholeTime whole(cotton, known, 0.03, trials, {});
  const auto has = [&](const Setting& setting, const std::string& words) {
    const Result<std::string> found = whole.fault(setting);
    REQUIRE(found);
    INFO(text(setting) << ": " << *found);
    CHECK((words.empty() ? found->empty() : found->find(words) != std::string::npos));
  };
  has({Method::bdf2, 1.0 / 120, 10, 1e-5}, "");
  has({Method::implicit_euler, 1.0 / 30, 1, 1e-4}, "far from solved");
  has({Method::bdf2, 1.0 / 15, 1, 1e-4}, "half of its step");
  has({Method::vbd, 1.0 / 60, 10, 1e-4}, "its energy rises");
  has({Method::verlet, 1e-3, 1, 1e-4}, "blows up");
  // Where wind does work, energy tells nothing, but stretch does.
  cotton.wind = scene::Wind{};
  has({Method::vbd, 1.0 / 60, 4, 1e-4}, "stretches the cloth");
}

TEST_CASE("woven cloth has a reference, which RK4 confirms within its estimate") {
  scene::Scene scene = test::sheet_of_elements(Method::implicit_euler, 1e-2, 11, 1e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene::Fem& woven = std::get<scene::Fem>(scene.cloths[0].material);
  woven.warp = 2365.0;
  woven.weft = 3801.0;
  woven.shear = 97.0;
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{10, 0}, {}}};
  const double time = 0.06;
  const Truth found = truth_of(scene, {time, 1e-8, 60.0});
  INFO(found.horizon_reason);
  CHECK(found.pace.method == reference::Pace::Method::esdirk);
  CHECK(found.why_no_reference.empty());
  CHECK(found.horizon == time);
  CHECK(found.position_error < 1e-6 * found.size);
  REQUIRE(found.position.size() == samples_to_horizon);
  // RK4 at its limit has an error far below.
  reference::Follower follower(
      found.world, {reference::Pace::Method::rk4, 1.0 / reference::fastest_rate(found.world)}, {});
  reference::State exact = reference::at_rest(found.world);
  follower.follow(exact, 0.0, time);
  const double off = reference::rms_distance(found.position.back(), exact.position);
  INFO("off by " << off << " m, said " << found.position_error << " m");
  CHECK(off < 3.0 * found.position_error);
}

TEST_CASE(
    "a scene too stiff for a reference is told so, with what can be charted and what would bring it back") {
  const auto gpu = test::context();
  scene::Scene stiff = swinging();
  stiff.cloths[0].springs().structural = 1e20;  // no equation of it is solved in double precision
  const Truth none = truth_of(stiff, {1.0, 1e-5, 0.5});
  CHECK(none.energy.empty());
  CHECK(none.why_no_reference.find("softer") != std::string::npos);
  const Chart made = chart_of(stiff, {{Method::xpbd, Method::verlet}, {1}, 0.02, 1.5});
  REQUIRE_FALSE(made.points.empty());
  for (const Axis axis : {Axis::position, Axis::energy, Axis::strain}) {
    CHECK_FALSE(made.axes[index(axis)].available);
    CHECK(made.axes[index(axis)].reason.find("There is no reference") == 0);
  }
  for (const Point& point : made.points) CHECK((point.cost || point.blew_up_at));
  const Result<Choice> choice = choose(stiff, {1e-2, {}, 1.0}, {});
  REQUIRE_FALSE(choice);
  CHECK(choice.error().remedy.find("chart") != std::string::npos);
}

TEST_CASE("the chart of the swinging cloth shows each method's order, float32's floor, and who blows up") {
  const auto gpu = test::context();
  ChartRequest request{{Method::symplectic_euler, Method::verlet, Method::rk4, Method::xpbd}, {1}, 0.3, 25.0};
  const Chart made = chart_of(swinging(), request);
  CHECK(made.complete);
  CHECK(made.horizon == 0.3);
  // The first two rungs below the limit, 0.95 and 0.48 of it; higher orders of dt add less than 0.15 there.
  for (const auto& [method, of_theory] : {std::pair{Method::symplectic_euler, 1.0}, {Method::verlet, 2.0}}) {
    const std::vector<Point> points = points_of(made, method);
    REQUIRE(points.size() >= 2);
    CAPTURE(scene::name(method));
    CHECK(std::abs(order(points[0], points[1]) - of_theory) < 0.15);
  }
  // At dt = 0.6 u: 7.8e-4 and 3.4e-5 m (tests/README.md), for a size of 0.5 m. The step here is up to 4 %
  // shorter.
  CHECK(std::abs(*points_of(made, Method::symplectic_euler)[0].error[0] / 1.56e-3 - 1.0) < 0.05);
  CHECK(std::abs(*points_of(made, Method::verlet)[0].error[0] / 6.8e-5 - 1.0) < 0.09);
  // Verlet keeps the energy: it swings by (omega dt)^2 in the fastest modes, which carry little.
  CHECK(*points_of(made, Method::verlet)[0].error[index(Axis::energy)] < 1e-3);
  // RK4 at half its limit is at float32's floor: 3.7e-7 to 7.4e-7 m there, and no shorter step is below a
  // third.
  const std::optional<double> floor = made.axes[index(Axis::position)].float32_floor;
  REQUIRE(floor);
  CHECK(*floor > 0.2e-6);
  CHECK(*floor < 3e-6);
  for (const Point& point : points_of(made, Method::rk4)) CHECK(*point.error[0] > *floor / 3);
  int crosses = 0;
  for (const Point& point : made.points) {
    if (!point.blew_up_at) continue;
    ++crosses;
    CHECK(point.dt_over_limit.value_or(0) > 1.0);
    CHECK_FALSE(point.error[0]);
  }
  CHECK(crosses == 3);  // all but XPBD, 5 % beyond their limits
}

TEST_CASE(
    "the choice keeps its tolerance when it is run again, with a margin, and nothing tried is cheaper") {
  const auto gpu = test::context();
  const double tolerance = 1e-3;
  const auto made =
      choose(swinging(), {tolerance, {Method::symplectic_euler, Method::verlet, Method::xpbd}, 0.3}, {});
  if (!made) FAIL(made.error().text());
  REQUIRE(made->met);
  const Setting& chosen = made->chosen.setting;
  CHECK(made->chosen.dt_over_limit.value_or(0.0) <= 0.9 * (1 + 1e-9));
  REQUIRE(made->runner_up);
  CHECK(made->runner_up->setting.method != chosen.method);

  const auto exact =
      reference::trajectory(*reference::make_world(swinging(), 0.0), {0.15, 0.3}, test::cloth_unit / 25);
  REQUIRE(exact);
  auto simulation = sim::Simulation::create(with(swinging(), chosen));
  REQUIRE(simulation);
  const auto steps = static_cast<std::uint32_t>(std::lround(0.3 / chosen.dt));
  (*simulation)->step(steps);
  const sim::State read = (*simulation)->read_state();
  const double error =
      reference::rms_distance({read.position.begin(), read.position.end()}, exact->states[1].position) / 0.5;
  // The same bits as in the choice, against a reference that is off by about 1e-7.
  CHECK(std::abs(error / *made->chosen.error[index(Axis::position)] - 1.0) < 0.01);
  CHECK(*made->chosen.largest_position_error <= tolerance);
  CHECK(error <= tolerance);

  // A scene that has this setting already keeps it, and is told so.
  const auto again = choose(with(swinging(), chosen), {tolerance, {chosen.method}, 0.3}, {});
  if (!again) FAIL(again.error().text());
  INFO(again->why);
  CHECK(again->met);
  CHECK(again->chosen.setting == again->present.setting);
  CHECK(again->why.find("own setting is already the best found") != std::string::npos);
}

TEST_CASE("a job of the lab that is cancelled ends, and says that it is not complete") {
  const auto gpu = test::context();
  std::stop_source stop;
  Control<Chart> control;
  control.stop = stop.get_token();
  control.arrived = [&](const Chart& so_far) {
    if (so_far.points.size() >= 2) stop.request_stop();
  };
  const Result<Chart> some = chart(swinging(), {{}, {}, 0.3, 60.0}, control);
  REQUIRE(some);
  CHECK_FALSE(some->complete);
  CHECK(some->points.size() >= 2);
  CHECK(some->points.size() <= 3);
  const Result<Choice> none = choose(swinging(), {}, {stop.get_token()});
  REQUIRE_FALSE(none);
  CHECK(was_cancelled(none.error()));
}

TEST_CASE(
    "the choice for a sheet that its weight stretches and stiffens is a step that holds there, with a "
    "margin") {
  const auto context = test::context();
  scene::Scene scene = test::sheet_of_elements(Method::verlet, 1e-4, 9, 1e-4);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.cloths[0].mass.value = 0.8;
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
  const Result<Choice> choice = choose(scene, {1e-2, {Method::verlet}, 0.5}, {});
  INFO((choice ? choice->why : choice.error().text()));
  REQUIRE(choice);
  CHECK(choice->met);
  CHECK(choice->why.find("as long as holds with a margin") != std::string::npos);
  // About the shape of rest 0.9 of the limit would do; a ninth longer than that blows up in this scene.
  CHECK(*choice->chosen.dt_over_limit < 0.85);
  CHECK(*choice->chosen.error_high <= 1e-2);
  for (const double longer : {1.0, 1.0 / 0.9}) {
    scene::Scene held = scene;
    held.solver.dt = longer * choice->chosen.setting.dt;
    TrialRunner trials;
    const Result<Trial> trial = trials.run(held, truth_of(scene, {0.5, 1e-7, 30.0}), 0.5, {});
    REQUIRE(trial);
    CHECK_FALSE(trial->blew_up_at);
  }
}
