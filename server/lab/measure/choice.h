// Chooses the cheapest setting that keeps a tolerance on a scene.
#pragma once

#include <string>
#include <vector>

#include "server/lab/measure/chart.h"

namespace clothlab::lab {

struct Choice {
  std::string scene, renderer;
  Origin origin{};
  double tolerance = 0;          ///< largest RMS position error allowed, over the cloth's size
  double time = 0, horizon = 0;  ///< simulated, and until when positions can be compared [s]
  double asked = 0;              ///< the time over which the tolerance is to be kept [s]
  std::string horizon_reason;    ///< how the horizon was found, and why it is less than `asked`: sentences
  double reference_error = 0;    ///< RMS position error of the reference itself, over the cloth's size
  bool met = false;              ///< true: `chosen` keeps the tolerance; false: it is the most accurate found
  /// Expected error: largest_position_error, between error_low and error_high; expected cost: cost.
  Point chosen;
  std::optional<Point> runner_up;  ///< the cheapest setting of another method that keeps the tolerance
  Point present;                   ///< the scene's own setting, measured the same way
  std::string why;                 ///< the reason for the choice, for the user
  std::vector<Point> tried;
  std::vector<std::string> notes;
  bool complete = false;
};

struct ChooseRequest {
  double tolerance = 1e-2;             ///< as Choice::tolerance, in (0, 1]
  std::vector<scene::Method> methods;  ///< empty: all that suit the scene
  std::optional<double> time;          ///< simulated time [s]; none: 1
};

/// The scene's own setting takes part, if it is of the wanted methods: it stays where nothing is surely
/// cheaper. Needs a current GL context. The chosen step is at most 0.9 of the stability limit; if the
/// tolerance is met, a run with a step a ninth longer did not blow up either. Beyond the horizon it keeps
/// what can be known without a reference (whole_time.h). Error: a tolerance out of range, a reference that is
/// missing or not accurate enough (with what can be done), all settings blew up, GL, or cancelled.
Result<Choice> choose(const scene::Scene& scene, const ChooseRequest& request,
                      const Control<Choice>& control);

}  // namespace clothlab::lab
