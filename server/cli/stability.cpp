// `clothlab stability S`: where each method becomes unstable, measured and by theory.
#include <iostream>
#include <memory>

#include "server/cli/lab_command.h"
#include "server/cli/lab_tables.h"
#include "server/lab/draw/plot.h"
#include "server/scene/method.h"

namespace clothlab::cli {

namespace {

using lab::brief;

struct StabilityOptions {
  LabOptions lab;
  std::string field = "stiffness";
  std::optional<double> from, to;
  int columns = 9;
};

std::string milliseconds(const std::optional<double>& seconds, const char* none) {
  return seconds ? brief(1000 * *seconds) : none;
}

void print_method(const lab::MethodMap& method) {
  std::cout << "\n" << scene::name(method.method) << "\n";
  std::vector<std::vector<std::string>> rows{{"value", "held [ms]", "failed [ms]", "theory [ms]", ""}};
  for (const lab::MapColumn& column : method.columns) {
    const std::string theory = !column.theory        ? "no limit"
                               : *column.theory == 0 ? "none is stable"
                                                     : milliseconds(column.theory, "");
    std::string remark = column.disagrees ? "more than 5 % apart" : "";
    if (!column.reason.empty()) remark += (remark.empty() ? "" : ": ") + column.reason;
    rows.push_back({brief(column.value), milliseconds(column.held, "none"),
                    milliseconds(column.failed, "none"), theory, remark});
  }
  print_table(rows);
}

void print_map(const lab::Outcome& outcome) {
  const lab::StabilityMap& map = std::get<lab::StabilityMap>(outcome);
  std::cout << map.scene << ", dt against " << map.field << (map.unit.empty() ? "" : " [" + map.unit + "]")
            << ", at most " << brief(map.time) << " s and " << map.steps << " steps a trial, on "
            << map.renderer << (map.complete ? "" : ", NOT COMPLETE") << "\n"
            << "now: " << brief(map.present_value) << " and " << scene::name(map.present_method) << " at dt "
            << brief(1000 * map.present_dt) << " ms\n";
  for (const lab::MethodMap& method : map.methods) print_method(method);
  std::cout << "\n";
  print_notes(map.notes);
}

int stability(const StabilityOptions& options) {
  const auto methods = methods_of(options.lab);
  if (!methods) return fail(methods.error(), exit_usage);
  return run_lab(options.lab,
                 lab::MapRequest{*methods, options.field, options.from, options.to, options.columns},
                 print_map);
}

}  // namespace

void add_stability(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("stability", "map where each method becomes unstable, measured and by theory");
  const auto options = std::make_shared<StabilityOptions>();
  add_lab_options(*command, options->lab);
  add_methods(*command, options->lab);
  add_shard(*command, options->lab);
  command
      ->add_option("--field", options->field,
                   "the number of the scene that is varied against dt, by JSON Pointer; or all stiffnesses")
      ->type_name("POINTER")
      ->capture_default_str();
  command->add_option("--from", options->from, "its least value (else a hundredth of the present)")
      ->type_name("V");
  command->add_option("--to", options->to, "its largest (else a hundred times the present)")->type_name("V");
  command->add_option("--columns", options->columns, "how many values, 2 to 41")
      ->type_name("N")
      ->capture_default_str();
  command->footer(std::string(R"(Examples:
  clothlab stability seed --out results
  clothlab stability seed --methods verlet,rk4 --field /cloths/0/material/damping --from 0 --to 50 --columns 11
)") + lab_footer);
  command->callback([options, &exit_code] { exit_code = stability(*options); });
}

}  // namespace clothlab::cli
