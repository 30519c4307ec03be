// The cheapest way to step a scene that is good enough.
#pragma once

#include <string>
#include <vector>

#include "server/lab/measure/chart.h"

namespace clothlab::lab {

struct Choice {
  std::string scene, renderer;
  double tolerance = 0;          ///< asked for: RMS position error over the cloth's size
  double time = 0, horizon = 0;  ///< [s]
  double reference_error = 0;    ///< of the reference itself, in the same terms
  bool met = false;              ///< else `chosen` is the most accurate that was found
  Point
      chosen;  ///< expected error: largest_position_error, from error_low to error_high; expected cost: cost
  std::optional<Point> runner_up;  ///< the cheapest of another method that keeps the tolerance
  Point present;                   ///< the scene's own setting, measured the same way
  std::string why;                 ///< one sentence
  std::vector<Point> tried;
  std::vector<std::string> notes;
  bool complete = false;
};

struct ChooseRequest {
  double tolerance = 1e-2;             ///< (0, 1]
  std::vector<scene::Method> methods;  ///< empty: all
  std::optional<double> time;          ///< [s]; none: 1
};

/// Needs a current GL context. The chosen step is at most 0.9 of the stability limit, and the run with a step
/// a ninth longer did not blow up either. Error: no reference can be had (with what can be done), or
/// cancelled.
Result<Choice> choose(const scene::Scene& scene, const ChooseRequest& request,
                      const Control<Choice>& control);

}  // namespace clothlab::lab
