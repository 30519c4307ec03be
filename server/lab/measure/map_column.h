// One column of a stability map: a method on one scene, tried at many steps.
#pragma once

#include <functional>
#include <stop_token>

#include "server/lab/measure/energy_trial.h"
#include "server/lab/measure/stability_map.h"

namespace clothlab::lab {

/// The likely cause of a measured boundary that differs from theory's.
enum class Cause {
  none,       ///< the boundary is where theory has it
  too_short,  ///< growth beyond the limit is too slow to show in a trial
  tension,    ///< it is stretched, which stiffens the cloth
  bounded,    ///< the growth ends by itself before it is a blow-up
  shape,      ///< the cloth leaves its rest shape: its springs are turned or slack
  contacts,   ///< without colliders and self-collision the same step holds
  energy,     ///< a method that no step should make unstable gained energy
  unknown
};
/// The cause in words, such as "the cloth does not stay near its rest shape"; empty for Cause::none.
const char* phrase(Cause cause);

struct MeasuredColumn {
  MapColumn column;
  Cause cause = Cause::none;
  double time = 0;           ///< longest time that a trial simulated [s]
  int steps = 0;             ///< largest number of steps of a trial
  bool held_beyond = false;  ///< true if a step held that is longer than the shortest that failed
};

/// A simulation that is changed from one scene to the next, so that its kernels are compiled once.
class ReusedSimulation {
 public:
  /// The simulation of `scene`, ready to run. The next call changes it.
  Result<sim::Simulation*> prepare(const scene::Scene& scene);

 private:
  std::unique_ptr<sim::Simulation> simulation_;
};

/// Called before each trial with its step [s] and the share of the column that is done.
using AtTrial = std::function<void(double dt, double share)>;

/// Measures the stability boundary of the scene's own method to 1 %, from steps around theory's limit; a
/// method without a limit is tried at a few long steps. `value` becomes the column's value; `full` runs the
/// scene as it is, `bare` without contacts. Error: GL, or cancelled.
Result<MeasuredColumn> measure_column(const scene::Scene& scene, double value, ReusedSimulation& full,
                                      ReusedSimulation& bare, const std::stop_token& stop,
                                      const AtTrial& at_trial);

}  // namespace clothlab::lab
