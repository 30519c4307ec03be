// Runs one setting on the GPU and measures its errors, its cost and whether it blows up.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/truth.h"
#include "server/sim/simulation.h"

namespace clothlab::lab {

struct Trial {
  Errors error;                                  ///< [Axis]; none where the run was too short for a sample
  std::optional<double> largest_position_error;  ///< at any sample up to the horizon, over the size
  std::optional<double> blew_up_at;              ///< [s]
  bool late = false;                             ///< it took too long and was given up: it has no errors
  double wall = 0, simulated = 0;                ///< wall time of stepping alone [s]; simulated time [s]
  sim::Convergence convergence;                  ///< of the last step
  std::vector<glm::vec3> at_horizon;  ///< [vertex] positions [m]; empty: the horizon was not reached
};

/// Runs trials, and keeps its simulations from one trial to the next, so that kernels are compiled once for
/// each method. Needs the GL context that was current when the TrialRunner was made.
class TrialRunner {
 public:
  /// A simulation of `scene` at time 0, its kernels compiled and warm. The pointer is valid until the next
  /// call.
  Result<sim::Simulation*> prepare(const scene::Scene& scene);

  /// Runs `scene` until `until` [s], compares it with the truth's samples on the way, and stops at a blow-up.
  /// Its step is first shortened so that a whole number of steps makes the horizon. It is given up once its
  /// stepping has taken `most_wall` [s]. Error: GL, or cancelled.
  Result<Trial> run(scene::Scene scene, const Truth& truth, double until, const std::stop_token& stop,
                    double most_wall = std::numeric_limits<double>::infinity());

  /// The state of `scene` after `time` [s], rounded to whole steps; none if the run blew up. Error: GL, or
  /// cancelled.
  Result<std::optional<sim::State>> run_to(const scene::Scene& scene, double time,
                                           const std::stop_token& stop);

  /// Times `scenes` in turns, `rounds` times each: after a warm-up that does not count, a scene runs from its
  /// start for `simulated` seconds of simulated time, or until it has taken `most` [s] of wall time. Returns
  /// [scene][round] [ms per simulated second].
  Result<std::vector<std::vector<double>>> time(const std::vector<scene::Scene>& scenes, double simulated,
                                                double most, int rounds, const std::stop_token& stop);

  /// Whether `run` measures how far its last step is from solved.
  void measure_convergence(bool on) { measures_convergence_ = on; }

 private:
  bool measures_convergence_ = false;
  /// By method and the number of sweeps for which the kernels were made (0 for a method that does not sweep).
  std::map<std::pair<scene::Method, int>, std::unique_ptr<sim::Simulation>> simulations_;
};

/// Summarises the timings of one scene [ms per simulated second].
Cost cost_of(const std::vector<double>& times);

/// The number of steps from the start to `truth.horizon` (without one, to `truth.time`) with a step of at
/// most `dt` [s]. It is rounded up by at most 4 % to a multiple of 4, 8, ... 64 (where there are few steps,
/// to the next multiple of 4), so that many steps end at one of the truth's samples.
int steps_to_horizon(double dt, const Truth& truth);
/// The step [s] that belongs to `steps_to_horizon`, rounded to six digits.
double fitted_dt(double dt, const Truth& truth);

}  // namespace clothlab::lab
