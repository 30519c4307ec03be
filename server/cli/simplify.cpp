// `clothlab simplify S`: what changes, and what is saved, if parts of the model are left out or made coarser.
#include <cmath>
#include <iostream>
#include <memory>

#include "server/cli/lab_command.h"
#include "server/cli/lab_tables.h"
#include "server/lab/draw/plot.h"

namespace clothlab::cli {

namespace {

using lab::brief;

constexpr std::size_t longest_patch = 2000;  // [bytes] to print; a patch with a triangle mesh is longer

struct SimplifyOptions {
  LabOptions lab;
  double tolerance = 0.01, time = 1;
};

std::string verdict(const lab::Variant& variant, double tolerance) {
  if (variant.recommended_to_drop) return "can go";
  if (!variant.change || *variant.change > tolerance || variant.saving != lab::Saving::cannot_tell)
    return "keep";
  return "keep: within the noise";
}

std::vector<std::string> row(const lab::Variant& variant, const std::string& verdict) {
  if (!variant.measured) return {variant.name, "-", "-", "-", "-", variant.reason};
  return {variant.name,
          lab::text(variant.cost_ratio),
          variant.change ? brief(*variant.change, 2) : "-",
          variant.error[0] ? brief(*variant.error[0], 2) : "-",
          std::isfinite(variant.dt_limit) ? brief(1000 * variant.dt_limit) : "none",
          verdict};
}

void print_simplification(const lab::Outcome& outcome) {
  const lab::Simplification& result = std::get<lab::Simplification>(outcome);
  print_heading(result.scene, result.time, result.renderer, result.complete);
  std::cout << "stepped by " << lab::text(result.setting) << "; a part may change at most "
            << brief(result.tolerance) << " of the size by " << brief(result.horizon) << " s\n\n";
  std::vector<std::vector<std::string>> rows{{"", "cost", "change", "error", "longest dt [ms]", ""},
                                             row(result.whole, "")};
  for (const lab::Variant& variant : result.variants)
    rows.push_back(row(variant, verdict(variant, result.tolerance)));
  if (result.drops_several()) rows.push_back(row(result.recommended, "recommended"));
  print_table(rows);
  std::cout << "\n";
  if (!result.why.empty()) std::cout << result.why << "\n";
  if (!result.recommended.patch.empty()) {
    const std::string patch = result.recommended.patch.dump();
    std::cout << "patch: "
              << (patch.size() > longest_patch ? "see recommended in simplify.json (--out)" : patch) << "\n";
  }
  print_notes(result.notes);
}

int simplify(const SimplifyOptions& options) {
  for (const Status& checked : {check_positive("--tolerance", options.tolerance, 1),
                                check_positive("--time", options.time, most_lab_time)})
    if (!checked) return fail(checked.error(), exit_usage);
  return run_lab(options.lab, lab::SimplifyRequest{options.tolerance, options.time}, print_simplification);
}

}  // namespace

void add_simplify(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("simplify", "measure what parts of a scene's model are worth, and which can go");
  const auto options = std::make_shared<SimplifyOptions>();
  add_lab_options(*command, options->lab);
  command
      ->add_option("--tolerance", options->tolerance,
                   "what a part may change: RMS distance over the cloth's size, (0, 1]")
      ->type_name("E")
      ->capture_default_str();
  add_time(*command, options->time,
           "the simulated time over which results are compared [s]; shorter where motions are chaotic");
  command->footer(std::string(R"(Examples:
  clothlab simplify seed
  clothlab simplify tablecloth --tolerance 0.05 --out results
)") + lab_footer);
  command->callback([options, &exit_code] { exit_code = simplify(*options); });
}

}  // namespace clothlab::cli
