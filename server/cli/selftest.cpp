// `clothlab selftest`: whether this device does it right, a line for each check.
#include "server/selftest/selftest.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "server/base/files.h"
#include "server/cli/commands.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"

namespace clothlab::cli {

namespace {

struct SelftestOptions {
  selftest::Options checks;
  std::string json, places;
  std::vector<std::string> only;
  std::optional<int> gpu;
};

int write_places(const std::string& folder) {
  const Status written = selftest::write_places(folder);
  return written ? exit_done : fail(written.error(), exit_internal);
}

int selftest_device(const SelftestOptions& options) {
  if (!options.json.empty())
    if (Status writable = check_writable("--json", options.json); !writable)
      return fail(writable.error(), exit_usage);
  gl::compute_without_helper_threads();  // as small cloths do
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(options.gpu);
  if (!context) return fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
  if (!options.places.empty()) return write_places(options.places);
  const gl::Device& device = (*context)->device();
  const std::string name = device.name + ", OpenGL " + device.version;
  std::cout << "clothlab " CLOTHLAB_VERSION " on " << name << std::endl;
  selftest::Report report(
      [](const selftest::Check& check) { std::cout << selftest::line(check) << std::endl; }, options.only);
  selftest::run(report, options.checks);
  if (report.checks().empty())
    return fail({"--only", "no check's name begins so", "`clothlab selftest --quick` tells names"},
                exit_usage);
  const std::size_t wrong = report.failed();
  std::cout << report.checks().size() << " checks, "
            << (wrong == 0 ? "all passed: this device does it right"
                           : std::to_string(wrong) + " failed: this device does not do it right")
            << (options.checks.quick || !options.only.empty() ? " (others were left out)" : "") << std::endl;
  if (!options.json.empty())
    if (Status written = write_file(options.json, report.as_json(name).dump(1) + "\n"); !written)
      return fail(written.error(), exit_internal);
  return wrong == 0 ? exit_done : exit_internal;
}

}  // namespace

void add_selftest(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "selftest", "whether this device does it right: its limits, all programs, short scenes, frames");
  const auto options = std::make_shared<SelftestOptions>();
  command->add_flag("--quick", options->checks.quick, "fewer programs and scenes: half a minute at most");
  command
      ->add_option("--only", options->only, "makes only checks whose name begins so, e.g. \"scene: swing\"")
      ->type_name("NAME");
  command->add_option("--json", options->json, "writes the checks as JSON")->type_name("F");
  command
      ->add_option("--write-places", options->places,
                   "checks nothing: writes what other devices are compared with, of this one, to a folder "
                   "(server/selftest/README.md)")
      ->type_name("FOLDER");
  add_gpu(*command, options->gpu);
  command->footer(
      "Prints a line for each check: what is right, or what is wrong and what to do.\n"
      "Exit code 0: this device does it right; 1: it does not; 3: there is no usable OpenGL.");
  command->callback([options, &exit_code] { exit_code = selftest_device(*options); });
}

}  // namespace clothlab::cli
