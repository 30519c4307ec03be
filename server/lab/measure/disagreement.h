// Explains why a measured stability boundary differs from theory's, by looking at what the cloth did.
#pragma once

#include <functional>
#include <string>

#include "server/lab/measure/map_column.h"
#include "server/model/extreme_mode.h"

namespace clothlab::lab {

/// The largest relative difference between the measured boundary and theory's at which they agree.
inline constexpr double agreement = 0.05;

/// The vibration about the rest shape that grows first when the step exceeds the method's limit.
model::Mode fastest_growing(scene::Method method, const model::ElementOperator& springs,
                            const std::stop_token& stop);

/// The measured boundary [s]: the geometric mean of the longest step that held and the shortest that failed;
/// if one of the two is missing, the other. None: both are missing.
std::optional<double> measured_boundary(const MapColumn& column);

bool disagrees(const MapColumn& column);

/// What explain() needs to know besides the column.
struct Evidence {
  const scene::Scene& scene;
  model::Mode mode;                     ///< the vibration that grows first
  double shortest_visible_dt = 0;       ///< shortest step whose growth shows within `steps` steps [s]
  int steps = 0;                        ///< number of steps of a trial at the limit
  std::function<int(double)> steps_of;  ///< number of steps of a trial with the given dt [s]
  std::string failure;                  ///< what grew at the shortest step that failed, in numbers
};

struct Explanation {
  Cause cause = Cause::unknown;
  std::string reason;  ///< a sentence without its full stop
};

/// The likely cause of a disagreement. Runs the scene again near the boundary where that can show the cause:
/// with `full`, and with `bare` without contacts. Error: GL, or cancelled.
Result<Explanation> explain(const MapColumn& column, const Evidence& evidence, ReusedSimulation& full,
                            ReusedSimulation& bare, const std::stop_token& stop);

}  // namespace clothlab::lab
