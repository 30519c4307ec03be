// Stepping a scene as fast as possible, with stops to read its state; shared by `run`, `render` and `record`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/result.h"
#include "server/cli/commands.h"
#include "server/gl/context.h"
#include "server/sim/guarded_run.h"
#include "server/sim/simulation.h"

namespace clothlab::cli {

/// Where software OpenGL computes the only scene of this program.
gl::HelperThreads threads_for(const scene::Scene& scene);

/// Adds `--gpu N`.
void add_gpu(CLI::App& command, std::optional<int>& gpu);

/// A scene ready to step, in the GL context of this thread.
struct Prepared {
  std::unique_ptr<gl::Context> context;
  std::unique_ptr<sim::Simulation> simulation;
  double dt_limit;     ///< longest stable step, or a lower bound that dt is well below [s]
  std::string chosen;  ///< for the method `auto`: the chosen setting and the reason; else empty
};
/// Loads the scene and makes its simulation. For the method `auto` the lab first chooses a setting, with
/// notes on stderr. On failure prints the error on stderr, sets `exit_code` and returns nothing.
std::optional<Prepared> prepare(const SceneChoice& choice, std::optional<int> gpu, int& exit_code);

/// `seconds` as a number of steps of `dt` [s], rounded, with a note on stderr if rounding changed it. Error:
/// `seconds` is not finite or negative, or the steps are too many.
Result<std::uint64_t> whole_steps(const std::string& option, double seconds, double dt);

/// How far `advance` came.
struct Progress {
  sim::Diagnostics state;   ///< the final state; the last good one if the run diverged
  double step_seconds = 0;  ///< time of stepping until the GPU was done, without the stops [s]
  std::uint64_t steps = 0;  ///< the number of steps timed in `step_seconds`
  bool diverged = false;
  double diverged_by = 0;              ///< the simulated time at which the divergence was seen [s]
  sim::GuardedRun::Setback setback{};  ///< if it diverged: the reason, in numbers, and a remedy
};

using AtStop = std::function<Status(const sim::Diagnostics&)>;

/// Steps `steps` times. Calls `at_stop` at the start, after every `every` steps, and at the end. If the
/// simulation blows up, restores its last good state and returns. Error: the stop's, or the device was reset.
Result<Progress> advance(const Prepared& prepared, std::uint64_t steps, std::uint64_t every,
                         const AtStop& at_stop);

/// The exit code of a command whose steps are done. If they diverged, also prints a note on stderr: the
/// reason, what is kept, and a remedy.
int exit_after(const Progress& progress);

}  // namespace clothlab::cli
