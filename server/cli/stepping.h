// Stepping a scene as fast as it goes, with stops to look at it: shared by `run` and `render`.
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

/// `--gpu N`.
void add_gpu(CLI::App& command, std::optional<int>& gpu);

/// A scene ready to step, in the GL context of this thread.
struct Prepared {
  std::unique_ptr<gl::Context> context;
  std::unique_ptr<sim::Simulation> simulation;
  std::string chosen;  ///< for the method `auto`: what was chosen and why; empty for others
};
/// For the method `auto` the lab chooses first, and its words go to stderr. On failure says why on stderr and
/// leaves the exit code.
std::optional<Prepared> prepare(const SceneChoice& choice, std::optional<int> gpu, int& exit_code);

/// `seconds` as whole steps, rounded; says so on stderr when it was not whole. Error: not finite, negative,
/// too many.
Result<std::uint64_t> whole_steps(const std::string& option, double seconds, double dt);

/// How far `advance` came.
struct Progress {
  sim::Diagnostics state;   ///< at the end; the last good one if it diverged
  double step_seconds = 0;  ///< stepping alone, GPU finished, without the stops [s]
  std::uint64_t steps = 0;  ///< that were timed
  bool diverged = false;
  double diverged_by = 0;              ///< the simulated time at which that was seen [s]
  sim::GuardedRun::Setback setback{};  ///< why it did, in numbers, and what to do
};

using AtStop = std::function<Status(const sim::Diagnostics&)>;

/// Steps `steps` times, stopping at the start, every `every` steps and at the end; `at_stop` is called at
/// each. If it blows up the simulation is brought back to its last good state, and that is the end.
Result<Progress> advance(sim::Simulation& simulation, std::uint64_t steps, std::uint64_t every,
                         const AtStop& at_stop);

/// The note on stderr about a run that diverged: why, what is kept, and what to do.
void note_diverged(const Progress& progress);

}  // namespace clothlab::cli
