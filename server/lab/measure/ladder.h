// A method with a number of iterations, tried with ever shorter steps: where it begins, and when a shorter
// step is no longer worth it.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/truth.h"

namespace clothlab::lab {

struct Ladder {
  Setting next;
  double limit = 0;      ///< of the step, about the rest shape [s]; infinite: none
  double step_cost = 0;  ///< wall time of a step [s], as last seen; at first a guess
  double least_error = std::numeric_limits<double>::infinity();
  int risen = 0;
  bool done = false;

  /// What running the next step for `time` takes [s].
  double price(double time) const { return step_cost * time / next.dt; }

  /// To the next shorter step, or to the end. `error` of the present one: none if it blew up or nothing is
  /// known of errors; `own` is the reference's.
  void go_on(std::optional<double> error, std::optional<double> own);
};

/// Each over the next one on a ladder.
inline constexpr double rung = 2.0;

/// The longest stable step of a method about the scene's rest shape [s].
double limit_of(scene::Method method, const scene::Scene& scene, const Truth& truth);

/// One for each method and number of iterations that is asked for. Those with a step limit begin 5 % beyond
/// it.
std::vector<Ladder> make_ladders(const scene::Scene& scene, const ChartRequest& request, const Truth& truth);

}  // namespace clothlab::lab
