// What `chart`, `stability`, `choose` and `simplify` share: their options, the run of the job with progress,
// cache and Ctrl-C, and the output as files, table or JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/cli/commands.h"
#include "server/lab/job.h"

namespace clothlab::cli {

struct LabOptions {
  SceneChoice scene;
  std::string methods;  ///< "verlet,xpbd"; empty: all
  std::string out;      ///< folder; empty: no files
  bool fresh = false;   ///< measure anew, even if the cache has the result
  bool json = false;    ///< print the result as JSON instead of a table
  std::string shard;    ///< "i/n": only these methods; empty: all
  std::optional<int> gpu;
};

/// Adds S, --set, --out, --json, --fresh and --gpu.
void add_lab_options(CLI::App& command, LabOptions& options);
/// Adds --shard.
void add_shard(CLI::App& command, LabOptions& options);
/// Adds --methods.
void add_methods(CLI::App& command, LabOptions& options);
/// Adds --time, with the present value of `seconds` [s] as its default.
void add_time(CLI::App& command, double& seconds, const std::string& help);
/// The methods that --methods names; empty for all. Error: a name that no method has.
Result<std::vector<scene::Method>> methods_of(const LabOptions& options);
/// Checks that the value of `option` is a number above 0 and at most `most`.
Status check_positive(const std::string& option, double value, double most);

/// Runs the job or takes its result from the cache. Writes KIND.json, KIND.csv and KIND.svg into the folder
/// of --out, if given, and prints the result with `print` or as JSON. Ctrl-C ends the job early; the result
/// so far is still written and printed. Returns the exit code, 130 if interrupted. With --shard it measures
/// some of the methods, keeps each result below parts/ in that folder, and writes what all shards have so
/// far.
int run_lab(const LabOptions& options, const lab::Job& job, void (*print)(const lab::Outcome&));

/// The largest --time [s]; a larger one is taken for a mistake.
inline constexpr double most_lab_time = 1000;
/// The end of the help text of each of these commands.
extern const char* const lab_footer;

}  // namespace clothlab::cli
