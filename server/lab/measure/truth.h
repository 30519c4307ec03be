// The truth about a scene that the lab compares with: the reference's motion at sample times, its own error,
// and the horizon, the time until which motions can be compared vertex by vertex at all.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/reference/pace.h"
#include "server/reference/reference.h"

namespace clothlab::lab {

/// The number of samples from the start to the horizon. A run whose number of steps to the horizon is a
/// multiple of 2, 4, ... 64 meets 2, 4, ... 64 of the samples.
inline constexpr int samples_to_horizon = 64;

struct Truth {
  reference::World world;
  double size = 0;     ///< largest extent of a cloth at rest [m]
  double asked = 0;    ///< time to simulate that was asked for [s]
  double time = 0;     ///< simulated [s]: as asked for, or less where that was too much work, or where
                       ///< surfaces touch, of which the reference knows no contact
  double horizon = 0;  ///< positions can be compared up to this time [s]; 0: at no time
  std::string horizon_reason;    ///< how the horizon was found, and why it is less than `asked`: sentences
  std::string why_no_reference;  ///< why there is no reference, and what can be done; then `time` is as asked
                                 ///< for and there are no samples. Empty: there is a reference
  double spacing = 0;  ///< between two samples [s]: a 64th of the horizon (without one, of the time)
  std::vector<std::vector<glm::dvec3>>
      position;                ///< [sample up to the horizon][vertex] [m]; sample 0 is at `spacing`
  std::vector<double> energy;  ///< [sample up to `time`] total energy [J]
  std::vector<double> strain;  ///< [sample up to `time`] largest |l/L - 1|
  double energy_scale = 0;     ///< largest kinetic + elastic energy at any sample [J]
  double position_error = 0;   ///< the reference's own error at the horizon, RMS [m]
  double energy_error = 0, strain_error = 0;  ///< the reference's own errors, as shares (see Axis)
  reference::Pace pace;                       ///< the reference's method and steps
  std::vector<std::string> notes;             ///< for the user, whole sentences
};

struct TruthRequest {
  double time = 1.0;       ///< to simulate [s]
  double accuracy = 1e-7;  ///< error of the reference to aim for: RMS over size at the horizon
  double budget = 30.0;    ///< processor time to spend [s]
  std::optional<double> stiff_budget = {};  ///< the same for a scene too stiff for RK4 [s]; none: as `budget`
  /// Is told the truth as two runs have it, with its larger errors, before the steps are halved further,
  /// which takes most of the time. What it takes itself is not of the budget; its error ends the work.
  std::function<Status(const Truth& coarse)> early = {};
  bool beyond_touch = false;  ///< goes on where surfaces touch, of which the reference knows no contact
};

/// Runs the reference in double precision, by RK4 or, for a scene for which that costs less, by Esdirk
/// (reference/pace.h), halving its steps until two runs agree or the budget is spent. A stiff reference stops
/// at a hundred times `accuracy`. Shortens the time where the budget is not enough for it even at the longest
/// steps. Error: the scene cannot be built, or cancelled.
Result<Truth> truth(const scene::Scene& scene, const TruthRequest& request, const std::stop_token& stop,
                    const std::function<void(double share)>& progress);

}  // namespace clothlab::lab
