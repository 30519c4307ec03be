// One column of a stability map: a method on one scene, tried at many steps.
#pragma once

#include <functional>
#include <stop_token>

#include "server/lab/measure/energy_trial.h"
#include "server/lab/measure/stability_map.h"

namespace clothlab::lab {

/// What is likely behind a boundary that is not where theory has it.
enum class Cause {
  none,       ///< it is where theory has it
  too_short,  ///< growth beyond the limit is too slow to show in a trial
  tension,    ///< the springs are stretched, which stiffens the cloth
  bounded,    ///< what grows comes to an end before it is a blow-up
  shape,      ///< the springs are turned or slack
  contacts,   ///< without colliders and self-collision the same step holds
  energy,     ///< a method that no step should make unstable gained energy
  unknown
};
/// A phrase: "the springs are stretched, which adds stiffness across them".
const char* phrase(Cause cause);

struct MeasuredColumn {
  MapColumn column;
  Cause cause = Cause::none;
  double time = 0;           ///< simulated at most by one trial [s]
  int steps = 0;             ///< at most
  bool held_beyond = false;  ///< a step longer than the shortest that failed held
};

/// A way to run scenes with one method that keeps its kernels from one to the next.
class Runner {
 public:
  /// The scene, ready to be run.
  Result<sim::Simulation*> prepare(const scene::Scene& scene);

 private:
  std::unique_ptr<sim::Simulation> simulation_;
};

/// Told before each trial: its step [s] and the share of the column that is done.
using AtTrial = std::function<void(double dt, double share)>;

/// Measures the boundary of the scene's own method to 1 %, from steps around the theory's limit; a method
/// without a limit is tried at a few long steps. `bare` runs the scene without contacts. Error: GL, or
/// cancelled.
Result<MeasuredColumn> measure_column(const scene::Scene& scene, double value, Runner& runner, Runner& bare,
                                      const std::stop_token& stop, const AtTrial& at_trial);

}  // namespace clothlab::lab
