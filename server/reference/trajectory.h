// The true motion of a scene, whatever its method, by RK4 in double precision with a step far below every
// limit, and an estimate of its error.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

struct Trajectory {
  std::vector<State> states;  ///< one for each requested time
  /// For each requested time, the RMS distance over the vertices [m] to the same run with twice the step.
  /// Where RK4 keeps its order, the true error of `states` is about a fifteenth of this distance.
  std::vector<double> error;
  double dt = 0;  ///< the largest step of `states` [s]
};

/// Runs the scene twice from rest through `times` [s], which must rise and be above 0. The coarser run takes
/// steps of at most `largest_step` [s]; 0 means 0.02 / fastest_rate. An error if the times do not rise or the
/// motion is not finite.
Result<Trajectory> trajectory(const World& world, const std::vector<double>& times,
                              double largest_step = 0.0);

/// An upper bound of the fastest rate of the scene [1/s], by row sums: the larger of the angular frequency of
/// undamped springs and the rate at which damping and air drag can slow a vertex; at least 1e-3.
double fastest_rate(const World& world);

/// Root of the mean over the vertices of the squared distance [m].
double rms_distance(const std::vector<dvec3>& a, const std::vector<dvec3>& b);

}  // namespace clothlab::reference
