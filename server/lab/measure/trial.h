// One setting run on the GPU: what it gets wrong, whether it blows up, what it costs.
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
  Errors error;  ///< by Axis, those that the run was long enough for
  std::optional<double> largest_position_error;
  std::optional<double> blew_up_at;   ///< [s]
  double wall = 0, simulated = 0;     ///< stepping alone, GPU finished [s]; of simulated time [s]
  std::vector<glm::vec3> at_horizon;  ///< [vertex] [m]
};

/// Simulations that are kept from one trial to the next, so that kernels are compiled once a method. Needs
/// the GL context current in which it was made.
class Bench {
 public:
  /// Ready at time 0, kernels compiled and warm. The pointer is good until the next call.
  Result<sim::Simulation*> prepare(const scene::Scene& scene);

  /// Runs `scene`, its step no longer than now and the horizon a whole number of them, through the truth's
  /// samples until `until` [s], and judges each look. Error: GL, or cancelled.
  Result<Trial> run(scene::Scene scene, const Truth& truth, double until, const std::stop_token& stop);

  /// The state after `time` [s], rounded to whole steps; none if it blew up on the way. Error: GL, or
  /// cancelled.
  Result<std::optional<sim::State>> run_to(const scene::Scene& scene, double time,
                                           const std::stop_token& stop);

  /// Times scenes taking turns: a warm-up is discarded, then each runs from the start for `simulated` seconds
  /// of its own time, or until `most` [s] of wall time, `rounds` times. [scene][round] in ms per simulated
  /// second.
  Result<std::vector<std::vector<double>>> time(const std::vector<scene::Scene>& scenes, double simulated,
                                                double most, int rounds, const std::stop_token& stop);

 private:
  /// By method and, where it sweeps, what its kernels are made for.
  std::map<std::pair<scene::Method, int>, std::unique_ptr<sim::Simulation>> simulations_;
};

/// Of one scene's times.
Cost cost_of(const std::vector<double>& times);

/// Steps from the start to `truth.horizon` (without one, `truth.time`) at a step of at most `dt` [s]: rounded
/// up by at most 4 % to a multiple of 4, 8, ... 64 (few steps: to the next multiple of 4), so that many of
/// the truth's samples are met.
int steps_to_horizon(double dt, const Truth& truth);
/// The step that this makes, to six digits [s].
double fitted_dt(double dt, const Truth& truth);

}  // namespace clothlab::lab
