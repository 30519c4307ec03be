// Measures if the lab's choice keeps the tolerance. For each scene and tolerance it finds: the choice; its
// error in another simulation, at more times, against a reference with half the step; its cost in longer
// runs, by itself and over the cost of the scene's own setting; and every cheaper setting of a fine grid, to
// see which of them keep the tolerance. Prints a JSON document. Usage: bench_choose [SCENE...], where 17x17
// is the swinging cloth of tests/README.md; by default four scenes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "server/base/text.h"
#include "server/gl/context.h"
#include "server/lab/measure/choice.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"
#include "server/model/element_operator.h"
#include "server/model/stability.h"
#include "server/reference/follower.h"
#include "server/reference/trajectory.h"
#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/sim/colliders.h"
#include "tests/bench/seed.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using lab::Setting;
using scene::Method;

namespace {

constexpr int looks = 24;            // times at which the choice's error is measured
constexpr double finer = 1.08;       // ratio of the grid's successive steps
constexpr double long_enough = 0.4;  // wall time of one timing [s]
constexpr int rounds = 9, glances = 5;

struct Case {
  std::string name;
  scene::Scene scene;
  double time = 1.0;
};

Case named(const std::string& name) {
  if (name == "17x17")
    return {name, test::swinging_cloth(Method::symplectic_euler, 0.6 * test::cloth_unit), 0.3};
  const auto document = scene::load(name);
  if (!document) std::fprintf(stderr, "%s\n", document.error().text().c_str()), std::exit(2);
  return {name, document->scene};
}

/// Largest error of a setting at `looks` times up to the horizon, over the cloth's size.
double independent_error(const Case& of, const Setting& setting, const lab::Truth& truth) {
  const int steps = lab::steps_to_horizon(setting.dt, truth);
  std::vector<int> at;
  std::vector<double> times;
  for (int k = 1; k <= looks; ++k) {
    const int step = static_cast<int>(std::lround(double(k) * steps / looks));
    if (step < 1 || (!at.empty() && step == at.back())) continue;
    at.push_back(step);
    times.push_back(step * setting.dt);
  }
  reference::Follower follower(truth.world, truth.pace.halved(1), {});
  reference::State exact = reference::at_rest(truth.world);
  auto made = sim::Simulation::create(lab::with(of.scene, setting));
  const auto simulation = std::move(*made);
  double worst = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    simulation->step(static_cast<std::uint32_t>(at[k] - (k ? at[k - 1] : 0)));
    const sim::State read = simulation->read_state();
    follower.follow(exact, k ? times[k - 1] : 0.0, times[k]);
    worst = std::max(worst,
                     reference::rms_distance({read.position.begin(), read.position.end()}, exact.position));
  }
  return worst / truth.size;
}

struct Grid {
  int tried = 0;
  std::vector<Setting> better;  // cheaper by estimate, and within the tolerance
};

std::vector<int> iterations_of(Method method) {
  if (scene::sweeps(method)) return {1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32};
  if (method == Method::implicit_euler) return {1, 2, 3, 4};
  return {1};
}

Grid search(const Case& of, const lab::Choice& choice, const lab::Truth& truth, lab::TrialRunner& trials) {
  Grid grid;
  const model::Model& model = truth.world.model;
  for (const Method method : scene::methods) {
    const double limit =
        model::dt_limit(method, model::ElementOperator(model, of.scene, model.rest_position));
    if (limit == 0.0) continue;
    for (const int iterations : iterations_of(method)) {
      Setting setting{method, std::min({model::margin_to_warn * limit, truth.horizon / 8, 1.0 / 30}),
                      iterations, 1e-4};
      setting.dt = lab::fitted_dt(setting.dt, truth);
      // The least of several timings: a setting that is cheaper at a quiet moment counts as cheaper.
      const auto glance = *trials.time({lab::with(of.scene, setting)}, truth.horizon, 0.03, glances, {});
      double step_cost = lab::cost_of(glance.front()).minimum * setting.dt;
      for (; step_cost / setting.dt < choice.chosen.cost->median;
           setting.dt = lab::fitted_dt(setting.dt / finer, truth)) {
        const auto trial = *trials.run(lab::with(of.scene, setting), truth, truth.horizon, {});
        ++grid.tried;
        step_cost = std::min(step_cost, 1000.0 * trial.wall / trial.simulated * setting.dt);
        if (trial.largest_position_error && *trial.largest_position_error <= choice.tolerance) {
          grid.better.push_back(setting);
          break;  // shorter steps cost more
        }
      }
    }
  }
  return grid;
}

void print(const Case& of, double tolerance, bool last) {
  lab::ChooseRequest request;
  request.tolerance = tolerance;
  request.time = of.time;
  const double begun = bench::seconds();
  const auto choice = lab::choose(of.scene, request, {});
  const double spent = bench::seconds() - begun;
  std::printf("  {\"scene\": \"%s\", \"tolerance\": %g, ", of.name.c_str(), tolerance);
  if (!choice) {
    std::printf("\"refused\": \"%s\"}%s\n", choice.error().text().c_str(), last ? "" : ",");
    return;
  }
  const auto truth =
      *lab::truth(of.scene, {of.time, 1e-3 * std::min(1e-4, tolerance), 60.0}, {}, [](double) {});
  const Setting& chosen = choice->chosen.setting;
  const double error = independent_error(of, chosen, truth);
  lab::TrialRunner trials;
  const Grid grid = search(of, *choice, truth, trials);
  std::vector<scene::Scene> scenes{lab::with(of.scene, chosen), of.scene};
  for (const Setting& setting : grid.better) scenes.push_back(lab::with(of.scene, setting));
  const auto times = *trials.time(scenes, truth.horizon, long_enough, rounds, {});
  const double cost = lab::cost_of(times[0]).median;
  double best = cost;
  std::string best_name = lab::text(chosen);
  for (std::size_t i = 0; i < grid.better.size(); ++i) {
    const double of_grid = lab::cost_of(times[i + 2]).median;
    if (of_grid < best) best = of_grid, best_name = lab::text(grid.better[i]);
  }
  // Both over the cost of the scene's own setting at that moment: the lab makes no promise about the
  // machine's speed.
  const double own = lab::cost_of(times[1]).median;
  const std::string against_own =
      choice->present.cost
          ? formatted("%.3f", cost / own * choice->present.cost->median / choice->chosen.cost->median)
          : "null";
  std::printf(
      "\"choose_s\": %.1f, \"runs\": %zu, \"met\": %s, \"chosen\": \"%s\",\n   \"promised_error\": %.3e, "
      "\"promised_low\": %.3e, \"promised_high\": %.3e, \"error\": %.3e, \"within_promise\": %s, "
      "\"error_ratio\": %.3f, \"promised_ms\": %.2f, \"ms\": %.2f, \"cost_ratio\": %.3f, "
      "\"cost_ratio_to_own\": %s,\n"
      "   \"grid_points\": %d, \"grid_best\": \"%s\", \"grid_best_ms\": %.2f, \"over_grid_best\": %.3f,\n"
      "   \"scenes_own\": \"%s\", \"scenes_own_ms\": %.2f, \"times_cheaper\": %.2f,\n   \"why\": \"%s\"}%s\n",
      spent, choice->tried.size(), choice->met ? "true" : "false", lab::text(chosen).c_str(),
      *choice->chosen.largest_position_error, choice->chosen.error_low.value_or(NAN),
      choice->chosen.error_high.value_or(NAN), error,
      error <= choice->chosen.error_high.value_or(0.0) ? "true" : "false",
      error / *choice->chosen.largest_position_error, choice->chosen.cost->median, cost,
      cost / choice->chosen.cost->median, against_own.c_str(), grid.tried, best_name.c_str(), best,
      cost / best, lab::text(lab::setting_of(of.scene)).c_str(), own, own / cost, choice->why.c_str(),
      last ? "" : ",");
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  const auto context = gl::Context::create();
  if (!context) return std::fprintf(stderr, "%s\n", context.error().text().c_str()), 3;
  std::vector<std::string> names(arguments + 1, arguments + count);
  if (names.empty()) names = {"seed", "17x17", "hanging-strip", "flag"};
  constexpr double tolerances[] = {1e-2, 1e-3, 1e-4};
  std::printf(
      "{\n \"what\": \"the lab's choices against a second look and a full grid\",\n \"renderer\": \"%s\",\n"
      " \"choices\": [\n",
      (*context)->device().name.c_str());
  for (const std::string& name : names)
    for (const double tolerance : tolerances)
      print(named(name), tolerance, name == names.back() && tolerance == tolerances[2]);
  std::printf(" ]\n}\n");
}
