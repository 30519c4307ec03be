// The true motion of a scene, whatever its method: RK4 in double precision at a step far below every limit,
// and how far that may be off.
#pragma once

#include "server/reference/reference.h"

namespace clothlab::reference {

struct Trajectory {
  std::vector<State> states;  ///< at each of the times asked for
  /// RMS distance over the vertices to the same run at twice the step, at each of the times [m]. Where RK4
  /// keeps its order the states themselves are about 15 times nearer the truth.
  std::vector<double> error;
  double dt = 0;  ///< the largest step of `states` [s]
};

/// Follows the scene from rest through `times` [s], which rise from above 0. The coarser of the two runs
/// takes steps of at most `largest_step` [s]; 0 takes 0.02 / omega, with omega the bound below. An error
/// where the times do not rise or the motion is not finite.
Result<Trajectory> trajectory(const World& world, const std::vector<double>& times,
                              double largest_step = 0.0);

/// A bound of the fastest rate of the scene [1/s], by row sums: omega for undamped springs, else the larger
/// of that and the rate at which damping and air drag can slow a vertex.
double fastest_rate(const World& world);

/// Root of the mean over the vertices of the squared distance [m].
double rms_distance(const std::vector<dvec3>& a, const std::vector<dvec3>& b);

}  // namespace clothlab::reference
