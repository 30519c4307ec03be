// `clothlab choose S --tolerance E`: the cheapest way to step a scene that is good enough.
#include <cmath>
#include <iostream>
#include <memory>

#include "server/cli/lab_command.h"
#include "server/cli/lab_tables.h"
#include "server/lab/draw/plot.h"

namespace clothlab::cli {

namespace {

using lab::brief;

struct ChooseOptions {
  LabOptions lab;
  double tolerance = 0.01, time = 1;
};

/// " [0.9..1.1]"; an empty text if there is no finite interval.
std::string range(std::optional<double> low, std::optional<double> high) {
  if (!low || !high || !std::isfinite(*high)) return "";
  return " [" + brief(*low) + ".." + brief(*high) + "]";
}

std::vector<std::string> row(const char* what, const lab::Point& point) {
  return {what, lab::text(point.setting),
          point.blew_up_at ? "blew up at " + brief(*point.blew_up_at) + " s"
          : point.largest_position_error
              ? "error " + brief(*point.largest_position_error) + range(point.error_low, point.error_high)
              : "error unknown",
          point.cost ? brief(point.cost->median) + range(point.cost->low, point.cost->high) +
                           " ms per simulated second"
                     : ""};
}

void print_choice(const lab::Outcome& outcome) {
  const lab::Choice& choice = std::get<lab::Choice>(outcome);
  print_heading(choice.scene, choice.time, choice.renderer, choice.complete);
  if (choice.horizon < choice.asked) std::cout << choice.horizon_reason << "\n";
  std::cout << "wanted: an error of at most " << brief(choice.tolerance) << " up to " << brief(choice.horizon)
            << " s (RMS over the cloth's size; the reference's own: " << brief(choice.reference_error, 2)
            << ")\n";
  if (choice.complete) {
    std::cout << choice.why << "\n\n";
    std::vector<std::vector<std::string>> rows{row(choice.met ? "chosen" : "nearest", choice.chosen)};
    if (choice.runner_up) rows.push_back(row("runner-up", *choice.runner_up));
    rows.push_back(row("now", choice.present));
    print_table(rows);
    std::cout << "\noptions: " << set_options(choice.chosen.setting)
              << "\npatch:   " << lab::patch(choice.chosen.setting).dump() << "\n";
  } else {
    std::cout << lab::count(choice.tried.size(), "setting") << " tried, nothing chosen yet\n";
  }
  print_notes(choice.notes);
  if (choice.complete && !choice.met) note("nothing that was tried keeps the tolerance");
}

int choose(const ChooseOptions& options) {
  const auto methods = methods_of(options.lab);
  if (!methods) return fail(methods.error(), exit_usage);
  for (const Status& checked : {check_positive("--tolerance", options.tolerance, 1),
                                check_positive("--time", options.time, most_lab_time)})
    if (!checked) return fail(checked.error(), exit_usage);
  return run_lab(options.lab, lab::ChooseRequest{options.tolerance, *methods, options.time}, print_choice);
}

}  // namespace

void add_choose(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("choose", "find the cheapest method and step that keep a tolerance on a scene");
  const auto options = std::make_shared<ChooseOptions>();
  add_lab_options(*command, options->lab);
  add_methods(*command, options->lab);
  command
      ->add_option("--tolerance", options->tolerance,
                   "the largest error: RMS distance to the reference over the cloth's size, (0, 1]")
      ->required()
      ->type_name("E");
  add_time(*command, options->time,
           "the simulated time over which the tolerance must be kept [s]; shorter where motions are chaotic");
  command->footer(std::string(R"(Examples:
  clothlab choose seed --tolerance 0.01
  clothlab choose curtain --tolerance 1e-3 --methods verlet,rk4 --json
)") + lab_footer);
  command->callback([options, &exit_code] { exit_code = choose(*options); });
}

}  // namespace clothlab::cli
