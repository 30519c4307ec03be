// A ladder: a method with a number of iterations, tried with ever shorter steps. It knows its first step, and
// when a shorter step is no longer worth it.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/truth.h"

namespace clothlab::lab {

struct Ladder {
  Setting next;
  double limit = 0;      ///< step limit about the rest shape [s]; infinite: none
  double step_cost = 0;  ///< wall time of a step [s], as last measured; at first a guess
  double least_error = std::numeric_limits<double>::infinity();
  int steps_without_gain = 0;
  bool done = false;

  /// The wall time of a run of `time` [s] with the next step [s].
  double price(double time) const { return step_cost * time / next.dt; }

  /// Goes on to the next shorter step, or ends the ladder. `error` is that of the present step, none: it blew
  /// up or errors are unknown; `reference_error` is the reference's own error, and an error below it ends the
  /// ladder.
  void go_on(std::optional<double> error, std::optional<double> reference_error);
};

/// The ratio of each step to the next shorter step on a ladder.
inline constexpr double step_ratio = 2.0;

/// The longest stable step of a method about the scene's rest shape [s].
double limit_of(scene::Method method, const scene::Scene& scene, const Truth& truth);

/// One ladder for each method of `request` and number of iterations that is asked for. A ladder with a step
/// limit begins 5 % beyond the limit, but not with more than the longest step that is tried without a limit.
std::vector<Ladder> make_ladders(const scene::Scene& scene, const ChartRequest& request, const Truth& truth);

}  // namespace clothlab::lab
