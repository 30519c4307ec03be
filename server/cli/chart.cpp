// `clothlab chart S`: every method's speed against its accuracy on one scene.
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

#include "server/cli/lab_command.h"
#include "server/cli/lab_tables.h"
#include "server/lab/draw/plot.h"
#include "server/lab/exports.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"

namespace clothlab::cli {

namespace {

using lab::brief;

struct ChartOptions {
  LabOptions lab;
  std::string iterations;
  double time = 1, budget = 120;
};

/// A point's cost [ms per simulated second], time step and iterations: "57 (dt 1.6 ms ×4)".
std::string words(const lab::Point& point) {
  std::string words = brief(point.cost->median) + " (dt " + brief(1000 * point.setting.dt) + " ms";
  if (scene::iterates(point.setting.method)) words += " ×" + std::to_string(point.setting.iterations);
  return words + ")";
}

/// The cheapest point of `method` whose error on `axis` is at most `most`, in words; "-" if none is.
std::string cheapest(const lab::Chart& chart, scene::Method method, std::size_t axis, double most) {
  const lab::Point* best = nullptr;
  for (const lab::Point& point : chart.points) {
    if (point.setting.method != method || !point.cost || !point.error[axis] || *point.error[axis] > most)
      continue;
    if (!best || point.cost->median < best->cost->median) best = &point;
  }
  return best ? words(*best) : "-";
}

void print_best(const lab::Chart& chart) {
  const std::optional<lab::Axis> shown = lab::first_with_errors(chart);
  if (!shown) return;
  const std::size_t axis = lab::index(*shown);
  std::cout << "\nms of stepping per simulated second, cheapest with an error of " << lab::name(*shown)
            << " of at most\n";
  std::vector<std::vector<std::string>> rows{{"", "1e-2", "1e-3", "1e-4"}};
  for (const scene::Method method : scene::methods) {
    bool any = false;
    for (const lab::Point& point : chart.points) any = any || point.setting.method == method;
    if (!any) continue;
    rows.push_back({scene::name(method)});
    for (const double most : {1e-2, 1e-3, 1e-4}) rows.back().push_back(cheapest(chart, method, axis, most));
  }
  print_table(rows);
}

void print_blown_up(const lab::Chart& chart) {
  std::map<scene::Method, const lab::Point*> shortest;
  for (const lab::Point& point : chart.points) {
    if (!point.blew_up_at) continue;
    const lab::Point*& so_far = shortest[point.setting.method];
    if (!so_far || point.setting.dt < so_far->setting.dt) so_far = &point;
  }
  for (const auto& [method, point] : shortest)
    std::cout << "blew up: " << lab::text(point->setting) << ", at " << brief(*point->blew_up_at) << " s\n";
}

void print_chart(const lab::Outcome& outcome) {
  const lab::Chart& chart = std::get<lab::Chart>(outcome);
  print_heading(chart.scene, chart.time, chart.renderer, chart.complete);
  if (!chart.horizon_reason.empty()) std::cout << chart.horizon_reason << "\n";
  for (std::size_t axis = 0; axis < lab::all_axes.size(); ++axis)
    if (!chart.axes[axis].available && !chart.axes[axis].reason.empty())
      std::cout << "no error of " << lab::name(lab::all_axes[axis]) << ": " << chart.axes[axis].reason
                << "\n";
  print_best(chart);
  std::cout << "\n";
  print_blown_up(chart);
  for (const std::string& words : lab::left_out(chart)) std::cout << "left out: " << words << "\n";
  print_notes(chart.notes);
}

Result<std::vector<int>> iterations_of(const std::string& list) {
  std::vector<int> iterations;
  for (std::size_t at = 0; !list.empty() && at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    const std::string one = list.substr(at, end - at);
    const bool whole = !one.empty() && one.size() < 6 && one.find_first_not_of("0123456789") == one.npos;
    const int value = whole ? std::stoi(one) : 0;
    if (value < scene::ranges::iterations.minimum || value > scene::ranges::iterations.maximum)
      return Error{"--iterations", "\"" + one + "\"", "whole numbers from 1 to 10000, with commas between"};
    iterations.push_back(value);
    at = end + 1;
  }
  return iterations;
}

int chart(const ChartOptions& options) {
  const auto methods = methods_of(options.lab);
  if (!methods) return fail(methods.error(), exit_usage);
  const Result<std::vector<int>> iterations = iterations_of(options.iterations);
  if (!iterations) return fail(iterations.error(), exit_usage);
  for (const Status& checked : {check_positive("--time", options.time, most_lab_time),
                                check_positive("--budget", options.budget, 86400)})
    if (!checked) return fail(checked.error(), exit_usage);
  return run_lab(options.lab, lab::ChartRequest{*methods, *iterations, options.time, options.budget},
                 print_chart);
}

}  // namespace

void add_chart(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("chart", "measure every method's speed against its accuracy on a scene");
  const auto options = std::make_shared<ChartOptions>();
  add_lab_options(*command, options->lab);
  add_methods(*command, options->lab);
  add_shard(*command, options->lab);
  command
      ->add_option("--iterations", options->iterations,
                   "only these, of methods that iterate, e.g. 1,4,16 (else several)")
      ->type_name("N,M");
  add_time(*command, options->time, "how long each setting simulates [s]");
  command
      ->add_option("--budget", options->budget,
                   "wall time for all of it [s]; what comes too late is left out")
      ->type_name("S")
      ->capture_default_str();
  command->footer(std::string(R"(Examples:
  clothlab chart seed --out results
  clothlab chart my-scene.json --methods verlet,xpbd --iterations 1,4 --time 0.5 --budget 30
  clothlab chart seed --out results --shard 2/8
)") + lab_footer);
  command->callback([options, &exit_code] { exit_code = chart(*options); });
}

}  // namespace clothlab::cli
