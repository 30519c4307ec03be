// Why a measured boundary is not where theory has it, found by looking at what the cloth did.
#pragma once

#include <functional>
#include <string>

#include "server/lab/measure/map_column.h"
#include "server/model/extreme_mode.h"

namespace clothlab::lab {

/// Measured and theory this far apart are said to disagree.
inline constexpr double agreement = 0.05;

/// The vibration about the rest shape that grows first beyond the method's limit.
model::Mode fastest_growing(scene::Method method, const model::ElementOperator& springs,
                            const std::stop_token& stop);

/// Where the boundary lies: between the longest step that held and the shortest that failed, or, if one of
/// the two is missing, at the other.
std::optional<double> measured_boundary(const MapColumn& column);

bool disagrees(const MapColumn& column);

/// What is known of a column beside its cells.
struct Evidence {
  const scene::Scene& scene;
  model::Mode mode;                     ///< that grows first
  double visible = 0;                   ///< shortest step whose growth shows within `steps` [s]
  int steps = 0;                        ///< of a trial at the limit
  std::function<int(double)> steps_of;  ///< of a trial with that dt
  std::string failure;                  ///< of the shortest step that failed, in numbers
};

struct Explanation {
  Cause cause = Cause::unknown;
  std::string reason;  ///< a sentence without its full stop
};

/// Runs the scene again at the boundary where that can tell. Error: GL, or cancelled.
Result<Explanation> explain(const MapColumn& column, const Evidence& evidence, Runner& runner, Runner& bare,
                            const std::stop_token& stop);

}  // namespace clothlab::lab
