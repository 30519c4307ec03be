#include "server/cli/lab_command.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>

#include "server/base/text.h"
#include "server/cli/long_job.h"
#include "server/cli/shard.h"
#include "server/cli/state_files.h"
#include "server/cli/stepping.h"
#include "server/gl/context.h"
#include "server/lab/cache.h"
#include "server/lab/exports.h"
#include "server/lab/shards.h"
#include "server/scene/method.h"
#include "server/sweep/quiet.h"

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

void add_shard(CLI::App& command, LabOptions& options) {
  command
      .add_option(
          "--shard", options.shard,
          "measure every n-th method, from the i-th on, on one core; --out then gets what all shards have")
      ->type_name("I/N");
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

namespace {

/// Measures with progress on stderr. `so_far`, if given, gets what there is of a job that is stopped.
Result<lab::Outcome> measure(const scene::Document& document, const lab::Job& job,
                             const std::stop_token& stop, std::optional<lab::Outcome>* so_far = nullptr) {
  ProgressLine line;
  const lab::Control<lab::Outcome> control{stop, [&](const lab::Progress& progress) { line.show(progress); },
                                           [&](const lab::Outcome& partial) {
                                             if (so_far) *so_far = partial;
                                           }};
  return lab::run(document, job, control);
}

/// A chart's costs count only if no other program worked on the same cores.
Result<lab::Outcome> measure_part(const scene::Document& document, const lab::Job& job,
                                  const std::stop_token& stop) {
  const sweep::Quiet quiet;
  Result<lab::Outcome> outcome = measure(document, job, stop);
  if (!outcome) return outcome;
  const std::optional<double> others = quiet.others();
  if (auto* chart = std::get_if<lab::Chart>(&*outcome); chart && !(others && *others <= quiet.most_others))
    lab::leave_out_costs(*chart, "Other programs worked on the same cores: costs are left out.");
  return outcome;
}

/// The parts of a job in the folder of its shards. A part has one name on all machines.
class Parts {
 public:
  Parts(const scene::Document& document, std::vector<lab::Job> jobs, const std::string& out)
      : document_(document), jobs_(std::move(jobs)), folder_(fs::path(out) / "parts") {}

  /// Measures the parts of `shard` that are not there. Error: cancelled, or a part cannot be written.
  Status measure(const Shard& shard, const std::stop_token& stop, bool fresh) const {
    for (std::size_t i = shard.number - 1; i < jobs_.size(); i += shard.of) {
      if (!fresh && find(i)) continue;
      const Result<lab::Outcome> outcome = measure_part(document_, jobs_[i], stop);
      if (!outcome) return outcome.error();
      cache().keep(key(i), *outcome);
      if (!find(i))
        return Error{folder_.string(), "the result could not be written",
                     "check the disk's space and the folder's permissions"};
    }
    return ok();
  }

  /// All that are there, as one result; none: there are none.
  std::optional<lab::Outcome> joined() const {
    std::vector<lab::Outcome> parts;
    for (std::size_t i = 0; i < jobs_.size(); ++i)
      if (std::optional<lab::Outcome> part = find(i)) parts.push_back(std::move(*part));
    if (parts.empty()) return std::nullopt;
    return lab::joined(std::move(parts), jobs_.size());
  }

 private:
  /// A new one each time, which has nothing in its memory: others write into the folder, too.
  lab::Cache cache() const { return lab::Cache(folder_, {0, std::numeric_limits<std::uintmax_t>::max()}); }
  lab::CacheKey key(std::size_t i) const { return lab::cache_key(document_, jobs_[i], ""); }
  std::optional<lab::Outcome> find(std::size_t i) const { return cache().find(key(i)); }

  const scene::Document& document_;
  std::vector<lab::Job> jobs_;
  fs::path folder_;
};

int run_shard(const LabOptions& options, const scene::Document& document, const lab::Job& job,
              void (*print)(const lab::Outcome&)) {
  const Result<Shard> shard = shard_of(options.shard);
  if (!shard) return fail(shard.error(), exit_usage);
  if (options.out.empty())
    return fail({"--shard", "no --out", "the folder that all shards write into"}, exit_usage);
  Result<std::vector<lab::Job>> jobs = lab::split(document, job);
  if (!jobs) return fail_job(jobs.error());
  if (shard->of > jobs->size())
    note("there are " + std::to_string(jobs->size()) + " methods: more shards than these have nothing to do");
  gl::compute_without_helper_threads();
  const StopOnInterrupt interrupt;
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create(options.gpu);
  if (!context) return fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
  const Parts parts(document, std::move(*jobs), options.out);
  const Status measured = parts.measure(*shard, interrupt.token(), options.fresh);
  if (!measured && !lab::was_cancelled(measured.error())) return fail_job(measured.error());
  if (const std::optional<lab::Outcome> whole = parts.joined())
    if (const int code = report(options, *whole, print); code != exit_done) return code;
  if (measured) return exit_done;
  note("interrupted: the methods that are done are kept; the same command goes on from there");
  return exit_interrupted;
}

}  // namespace

int run_lab(const LabOptions& options, const lab::Job& job, void (*print)(const lab::Outcome&)) {
  const Result<scene::Document> document = options.scene.load();
  if (!document) return fail(document.error(), exit_usage);
  if (Status possible = check_out(options, lab::name(job)); !possible)
    return fail(possible.error(), exit_usage);
  if (!options.shard.empty()) return run_shard(options, *document, job, print);

  gl::compute_without_helper_threads();
  const StopOnInterrupt interrupt;
  const Result<std::unique_ptr<gl::Context>> context =
      gl::Context::create(options.gpu, threads_for(document->scene));
  if (!context) return fail(context.error(), context.error().where == "--gpu" ? exit_usage : exit_no_opengl);
  lab::Cache cache;
  const lab::CacheKey key = lab::cache_key(*document, job, gl::renderer_name());
  if (!options.fresh)
    if (const std::optional<lab::Outcome> known = cache.find(key)) {
      note("measured before on the same scene, build and device; --fresh measures again");
      return report(options, *known, print);
    }

  std::optional<lab::Outcome> so_far;
  const Result<lab::Outcome> outcome = measure(*document, job, interrupt.token(), &so_far);
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

}  // namespace clothlab::cli
