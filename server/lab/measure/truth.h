// What a scene really does, for the lab: the reference's motion at sample times, how far it can be trusted,
// and until when a motion can be compared vertex by vertex at all.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/reference/reference.h"

namespace clothlab::lab {

/// Samples from the start to the horizon, so that a run whose steps are a multiple of 2, 4, ... 64 meets 2,
/// 4,
/// ... 64 of them.
inline constexpr int samples_to_horizon = 64;

struct Truth {
  reference::World world;
  double size = 0;             ///< largest extent of a cloth at rest [m]
  double time = 0;             ///< simulated [s]: what was asked for, or less where that was too much work
  double horizon = 0;          ///< positions can be compared until then [s]; 0: at no time
  std::string horizon_reason;  ///< how it was found, a sentence
  std::string missing;  ///< why there is no reference at all, and what can be done; empty: there is one. Else
                        ///< `time` and `spacing` are as asked for, and there are no samples
  double spacing = 0;   ///< of the samples [s]; the horizon (without one, the time) is 64 of it
  std::vector<std::vector<glm::dvec3>>
      position;                ///< [sample up to the horizon][vertex] [m]; sample 0 is at `spacing`
  std::vector<double> energy;  ///< total, by sample, up to `time` [J]
  std::vector<double> strain;  ///< largest |l/L - 1|, by sample
  double energy_scale = 0;     ///< most kinetic + elastic energy over the samples [J]
  double position_error = 0;   ///< of the reference at the horizon, RMS [m]
  double energy_error = 0, strain_error = 0;  ///< of the reference, as shares (see Axis)
  double dt = 0;                              ///< the reference's step [s]
  std::vector<std::string> notes;             ///< what the user should know of it, whole sentences
};

struct TruthRequest {
  double time = 1.0;       ///< [s]
  double accuracy = 1e-7;  ///< wanted of the reference, RMS over size at the horizon
  double budget = 30.0;    ///< wall time [s]
};

/// RK4 in double precision, at steps halved until two runs agree or the budget is spent; the time is
/// shortened where not even the longest step fits into it. Error: the scene cannot be built, or cancelled.
Result<Truth> truth(const scene::Scene& scene, const TruthRequest& request, const std::stop_token& stop,
                    const std::function<void(double share)>& progress);

}  // namespace clothlab::lab
