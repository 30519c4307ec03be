#include "server/cli/lab_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>

#include "server/base/text.h"
#include "server/cli/long_job.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/gl/context.h"
#include "server/lab/cache.h"
#include "server/lab/exports.h"
#include "server/scene/method.h"

namespace clothlab::cli {

namespace fs = std::filesystem;

namespace {

constexpr std::array extensions{".json", ".csv", ".svg"};

std::string file_name(const LabOptions& options, const char* kind, const char* extension) {
  return (fs::path(options.out) / (std::string(kind) + extension)).string();
}

/// Makes the folder of --out if needed and checks that its files can be written; called before any work.
Status check_out(const LabOptions& options, const char* kind) {
  if (options.out.empty()) return ok();
  std::error_code failure;
  fs::create_directory(options.out, failure);
  if (!fs::is_directory(options.out, failure))
    return Error{"--out " + options.out, "is no folder and cannot be made one",
                 "name a folder that is there or whose parent is"};
  for (const char* extension : extensions)
    if (Status writable = check_writable("--out", file_name(options, kind, extension)); !writable)
      return writable;
  return ok();
}

Status write_files(const LabOptions& options, const lab::Outcome& outcome) {
  if (options.out.empty()) return ok();
  const char* kind = lab::name(outcome);
  const std::string json =
      lab::to_json(outcome).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::array texts{json, lab::csv(outcome), lab::svg(outcome)};
  for (std::size_t index = 0; index < texts.size(); ++index)
    if (Status written = write_file(file_name(options, kind, extensions[index]), texts[index]); !written)
      return written;
  return ok();
}

/// Prints the error of a job and returns the exit code. Jobs call their parameters by name, users by option:
/// "time" becomes "--time".
int fail_job(Error error) {
  for (const char* option : {"field", "from", "to", "columns", "tolerance", "time", "methods"})
    if (error.where == option) error.where = std::string("--") + option;
  // Errors in an option, the scene or the request are the user's; all others are the program's.
  const bool asked = error.where.starts_with("-") || error.where.starts_with("/") ||
                     error.where == "choose" || error.where == "simplify" || error.where == "chart" ||
                     error.where == "stability";
  return fail(error, asked ? exit_usage : exit_internal);
}

int report(const LabOptions& options, const lab::Outcome& outcome, void (*print)(const lab::Outcome&)) {
  if (Status written = write_files(options, outcome); !written) return fail(written.error(), exit_internal);
  if (options.json)
    std::cout << lab::to_json(outcome).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  else
    print(outcome);
  if (!options.out.empty() && !options.json)
    std::cout << "written: " << file_name(options, lab::name(outcome), ".json") << ", .csv, .svg\n";
  return exit_done;
}

}  // namespace

const char* const lab_footer = R"(
With --out the folder gets NAME.json, NAME.csv and NAME.svg. Results are kept below ~/.cache/clothlab/lab (or
$XDG_CACHE_HOME) by scene, job, build and device: asked again, they are there at once; --fresh measures anew.
Ctrl-C ends the work early and keeps what there is, marked incomplete; the exit code is 130 then. Times are
only worth something while nothing else runs.)";

void add_lab_options(CLI::App& command, LabOptions& options) {
  options.scene.add_positional(command);
  command.add_option("--out", options.out, "the folder for the result as JSON, CSV and SVG")
      ->type_name("DIR");
  command.add_flag("--json", options.json, "print the whole result as JSON");
  command.add_flag("--fresh", options.fresh, "measure, whatever was measured before");
  add_gpu(command, options.gpu);
}

void add_methods(CLI::App& command, LabOptions& options) {
  command.add_option("--methods", options.methods, "only these, e.g. verlet,xpbd (all: see `clothlab info`)")
      ->type_name("A,B");
}

void add_time(CLI::App& command, double& seconds, const std::string& help) {
  command.add_option("--time", seconds, help)->type_name("T")->capture_default_str();
}

Result<std::vector<scene::Method>> methods_of(const LabOptions& options) {
  std::vector<scene::Method> methods;
  std::string known;
  for (const scene::Method method : scene::methods)
    known += (known.empty() ? "" : ", ") + std::string(scene::name(method));
  if (options.methods.empty()) return methods;
  for (std::size_t at = 0; at <= options.methods.size();) {
    const std::size_t end = std::min(options.methods.find(',', at), options.methods.size());
    const std::string name = options.methods.substr(at, end - at);
    const std::optional<scene::Method> method = scene::method_of(name);
    if (!method) return Error{"--methods", "\"" + name + "\"", "some of " + known + ", with commas between"};
    if (std::find(methods.begin(), methods.end(), *method) == methods.end()) methods.push_back(*method);
    at = end + 1;
  }
  return methods;
}

Status check_positive(const std::string& option, double value, double most) {
  if (std::isfinite(value) && value > 0 && value <= most) return ok();
  return Error{option, with_significant_digits(value, 6),
               "above 0, at most " + with_significant_digits(most, 6)};
}

int run_lab(const LabOptions& options, const lab::Job& job, void (*print)(const lab::Outcome&)) {
  const Result<scene::Document> document = options.scene.load();
  if (!document) return fail(document.error(), exit_usage);
  if (Status possible = check_out(options, lab::name(job)); !possible)
    return fail(possible.error(), exit_usage);

  const StopOnInterrupt interrupt;
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(options.gpu);
  if (!context) return fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
  lab::Cache cache;
  const lab::CacheKey key = lab::cache_key(*document, job, gl::renderer_name());
  if (!options.fresh)
    if (const std::optional<lab::Outcome> known = cache.find(key)) {
      note("measured before on the same scene, build and device; --fresh measures again");
      return report(options, *known, print);
    }

  ProgressLine line;
  std::optional<lab::Outcome> so_far;
  const lab::Control<lab::Outcome> control{interrupt.token(),
                                           [&](const lab::Progress& progress) { line.show(progress); },
                                           [&](const lab::Outcome& partial) { so_far = partial; }};
  const Result<lab::Outcome> outcome = lab::run(*document, job, control);
  line.clear();
  if (outcome) {
    cache.keep(key, *outcome);
    return report(options, *outcome, print);
  }
  if (!lab::was_cancelled(outcome.error())) return fail_job(outcome.error());
  if (so_far)
    if (const int code = report(options, *so_far, print); code != exit_done) return code;
  note(so_far ? "interrupted: the result is incomplete" : "interrupted before there was any result");
  return exit_interrupted;
}

void print_table(const std::vector<std::vector<std::string>>& rows) {
  // Counts characters, not bytes: "×" and "⁻" are several bytes long but one column wide.
  const auto columns_of = [](const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char byte) { return (byte & 0xC0) != 0x80; }));
  };
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (column == widths.size()) widths.push_back(0);
      widths[column] = std::max(widths[column], columns_of(row[column]));
    }
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t column = 0; column < row.size(); ++column) {
      line += row[column];
      if (column + 1 < row.size()) line.append(widths[column] - columns_of(row[column]) + 2, ' ');
    }
    std::cout << line << "\n";
  }
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& words : notes)
    if (!words.empty()) std::cout << "note: " << words << "\n";
}

void print_heading(const std::string& what, double time, const std::string& renderer, bool complete) {
  std::cout << what << ", " << with_significant_digits(time, 6) << " s simulated on " << renderer
            << (complete ? "" : ", NOT COMPLETE") << "\n";
}

std::string set_options(const lab::Setting& setting) {
  std::string options;
  const nlohmann::json patch = lab::patch(setting);
  for (const auto& [key, value] : patch.at("solver").items())
    options += (options.empty() ? "--set /solver/" : " --set /solver/") + key + "=" +
               (value.is_string() ? value.get<std::string>() : value.dump());
  return options;
}

}  // namespace clothlab::cli
