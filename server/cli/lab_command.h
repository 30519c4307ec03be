// What `chart`, `stability`, `choose` and `simplify` share: their options, the run of the job with progress,
// cache and Ctrl-C, and the files it leaves.
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
  bool fresh = false;   ///< whatever the cache has
  bool json = false;    ///< the result on stdout as JSON, instead of the table
  std::optional<int> gpu;
};

/// S, --set, --out, --json, --fresh, --gpu.
void add_lab_options(CLI::App& command, LabOptions& options);
/// --methods.
void add_methods(CLI::App& command, LabOptions& options);
/// --time, whose default is what `seconds` is.
void add_time(CLI::App& command, double& seconds, const std::string& help);
/// The methods named, empty for all. Error: one that there is not.
Result<std::vector<scene::Method>> methods_of(const LabOptions& options);
/// `value` if it is a number above 0 and at most `most`. Error: says so of `option`.
Status check_positive(const std::string& option, double value, double most);

/// Runs the job, or takes its result from the cache; then writes KIND.json, .csv and .svg into --out and
/// prints with `print`, or as JSON. Ctrl-C ends it early and keeps what there is. Returns the exit code, 130
/// where it was interrupted.
int run_lab(const LabOptions& options, const lab::Job& job, void (*print)(const lab::Outcome&));

/// Simulated longer than this is a mistake [s].
inline constexpr double most_lab_time = 1000;
/// What every help of the lab's commands ends with.
extern const char* const lab_footer;

/// Rows of words in columns as wide as they need, two blanks apart; the first row is the header.
void print_table(const std::vector<std::vector<std::string>>& rows);
/// Every line of `words` that is not empty as "note: ...", on stdout.
void print_notes(const std::vector<std::string>& notes);
/// "1 s simulated on llvmpipe (...)", and whether it is all.
void print_heading(const std::string& what, double time, const std::string& renderer, bool complete);
/// The options that make a command step by `setting`.
std::string set_options(const lab::Setting& setting);

}  // namespace clothlab::cli
