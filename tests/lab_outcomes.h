// Made-up results of the lab, for tests of the exports and the cache.
#pragma once

#include <cmath>
#include <limits>

#include "server/lab/job.h"
#include "server/scene/method.h"

namespace clothlab::tests {

using lab::Axis;
using scene::Method;

/// A point whose error falls with dt, by `order`, from `error_at_ms` at dt = 1 ms to a floor; it costs
/// `ms_a_step` per step.
inline lab::Point made_up_point(Method method, double dt, int iterations, double error_at_ms, double order,
                                double ms_a_step) {
  lab::Point point;
  point.setting = {method, dt, iterations, 1e-4};
  const double error = error_at_ms * std::pow(dt / 1e-3, order) + 3e-6;
  point.error = {error, 0.4 * error, 2 * error, std::nullopt};
  point.largest_position_error = 1.3 * error;
  const double cost = ms_a_step / dt;
  point.cost = {cost, 0.95 * cost, 3};
  if (!scene::iterates(method)) point.dt_over_limit = dt / 1.9e-3;
  return point;
}

inline lab::Point made_up_blow_up(Method method, double dt, double at) {
  lab::Point point;
  point.setting = {method, dt, 1, 1e-4};
  point.blew_up_at = at;
  point.dt_over_limit = dt / 1.9e-3;
  return point;
}

/// Three methods, one of which sweeps; one point that blew up has a known cost, another has none.
inline lab::Chart made_up_chart() {
  lab::Chart chart;
  chart.scene = "seed";
  chart.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  chart.size = std::sqrt(2.0);
  chart.time = 1;
  chart.horizon = 0.42;
  chart.horizon_reason = "A copy moved by 1e-6 of the size stays within 1e-4 of it until 0.42 s.";
  chart.present = {Method::verlet, 1e-3, 10, 1e-4};
  chart.axes[0] = {true, "", 2e-9, 3e-6};
  chart.axes[1] = {true, "", 1e-8, std::nullopt};
  chart.axes[2] = {true, "", 1e-7, 1e-5};
  chart.axes[3] = {false, "the cloth does not come to rest: a pin moves for ever", std::nullopt,
                   std::nullopt};
  for (const double dt : {1.6e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4})
    chart.points.push_back(made_up_point(Method::verlet, dt, 10, 2e-3, 2, 0.06));
  chart.points.push_back(made_up_blow_up(Method::verlet, 2e-3, 0.03));
  for (const double dt : {1.6e-3, 8e-4, 4e-4, 2e-4, 1e-4})
    chart.points.push_back(made_up_point(Method::symplectic_euler, dt, 10, 3e-2, 1, 0.055));
  for (const int iterations : {1, 4, 16})
    for (const double dt : {16e-3, 8e-3, 4e-3, 2e-3, 1e-3, 5e-4})
      chart.points.push_back(
          made_up_point(Method::xpbd, dt, iterations, 8e-2 / iterations, 1, 0.06 + 0.05 * iterations));
  lab::Point blown = made_up_blow_up(Method::explicit_euler, 1e-3, 0.08);
  blown.cost = lab::Cost{55, 54, 2};
  chart.points.push_back(blown);
  chart.left_out = {{Method::explicit_euler, 1e-6, std::nullopt, "too slow for the budget"},
                    {Method::explicit_euler, 5e-7, std::nullopt, "too slow for the budget"},
                    {Method::vbd, std::nullopt, std::nullopt, "no sweep converges <here> & now"}};
  chart.notes = {"The machine was busy: times may be too long."};
  chart.complete = true;
  return chart;
}

inline lab::Choice made_up_choice() {
  const lab::Chart chart = made_up_chart();
  lab::Choice choice;
  choice.scene = chart.scene;
  choice.renderer = chart.renderer;
  choice.tolerance = 1e-2;
  choice.time = 1;
  choice.asked = 0.5;
  choice.horizon = 0.42;
  choice.horizon_reason =
      "Judged up to 0.42 s of the 0.5 s asked for. A copy is 100 times as far away soon after.";
  choice.reference_error = 2e-9;
  choice.met = true;
  choice.tried = chart.points;
  choice.chosen = chart.points[0];
  choice.runner_up = chart.points[7];
  choice.present = chart.points[1];
  choice.why =
      "verlet at 1.6 ms is the cheapest of 24 settings that keep 0.01, 3.7 times cheaper than the next.";
  choice.complete = true;
  return choice;
}

/// Two methods over three stiffnesses: one has a limit, which theory misses at the last value; the other has
/// none.
inline lab::StabilityMap made_up_map() {
  lab::StabilityMap map;
  map.scene = "seed";
  map.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  map.field = "stiffness";
  map.unit = "times the present";
  map.present_value = 1;
  map.present_dt = 1e-3;
  map.present_method = Method::verlet;
  map.time = 2;
  map.steps = 4000;
  lab::MethodMap verlet{Method::verlet, {}}, vbd{Method::vbd, {}};
  for (int column = 0; column < 9; ++column) {
    const double value = std::pow(10.0, -2 + 0.5 * column), limit = 1.9e-3 / std::sqrt(value);
    const double measured = column == 8 ? 1.1 * limit : limit;
    lab::MapColumn of_verlet{value, limit, 0.99 * measured, 1.01 * measured, column == 8, "", {}};
    if (column == 8) of_verlet.reason = "the air's drag helps";
    for (const double share : {0.25, 0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 2.5})
      of_verlet.cells.push_back(
          {share * measured, share < 1 ? 0.02 * share : 6 * (share - 0.95), share > 1.2});
    verlet.columns.push_back(of_verlet);
    lab::MapColumn of_vbd{value, std::nullopt, 0.1, std::nullopt, false, "", {}};
    for (const double dt : {1e-3, 1e-2, 1e-1})
      of_vbd.cells.push_back({dt, -0.8 * (3 + std::log10(dt)), false});
    vbd.columns.push_back(of_vbd);
  }
  map.methods = {vbd, verlet};
  map.notes = {"verlet at 100: measured 0.21 ms, theory 0.19 ms: the air's drag helps."};
  map.complete = true;
  return map;
}

inline lab::Simplification made_up_simplification() {
  lab::Simplification simplification;
  simplification.scene = "seed";
  simplification.renderer = "llvmpipe (LLVM 15.0.6, 256 bits)";
  simplification.tolerance = 1e-2;
  simplification.time = 1;
  simplification.horizon = 0.42;
  simplification.size = std::sqrt(2.0);
  simplification.setting = {Method::verlet, 1e-3, 10, 1e-4};
  const auto variant = [](const char* name, double change, double ratio, bool drop) {
    lab::Variant made;
    made.name = name;
    made.patch = {{"cloths", {{{"material", {{"bend", 0}}}}}}};
    made.measured = true;
    made.error = {change + 1e-4, 1e-3, 2e-3, std::nullopt};
    made.change = change;
    made.cost = lab::Cost{57 * ratio, 55 * ratio, 3};
    made.cost_ratio = {ratio, 0.96 * ratio, 1.03 * ratio};
    made.saving = lab::saving(made.cost_ratio);
    made.dt_limit = 1.9e-3;
    made.recommended_to_drop = drop;
    return made;
  };
  simplification.whole = variant("the whole scene", 0, 1, false);
  simplification.whole.patch = lab::json::object();
  simplification.variants = {variant("without bend springs", 2.4e-3, 0.71, true),
                             variant("without shear springs", 8.1e-2, 0.66, false),
                             variant("without damping", 3e-4, 0.93, true),
                             variant("half the mesh resolution", 2.2e-2, 0.21, false)};
  simplification.variants[2].dt_limit = std::numeric_limits<double>::infinity();
  lab::Variant absent;
  absent.name = "without self-collision";
  absent.patch = {{"self_collision", nullptr}};
  absent.reason = "the scene has none";
  simplification.variants.push_back(absent);
  simplification.recommended = variant("all of these together", 2.9e-3, 0.64, true);
  simplification.why = "Bend springs and damping change less than 0.01 and cost 36 % of the time.";
  simplification.complete = true;
  return simplification;
}

}  // namespace clothlab::tests
