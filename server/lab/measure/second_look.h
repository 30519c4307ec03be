// The largest position errors of settings, measured at every step or at many, so that a choice can promise
// them. A search compares only at the times that its runs and the reference have in common, as few as 4 where
// steps are long; the largest error may lie between these times.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "server/lab/measure/setting.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"

namespace clothlab::lab {

/// The largest position error up to the horizon, as a share of the cloth's size: between `low` and `high`.
/// `low` is `seen`, the largest error at any look, less the reference's own error; `high` is `seen` plus the
/// reference's own error and, if steps lie between two looks, half of the largest change of the error from
/// one look to the next.
struct LargestError {
  double seen = 0, low = 0, high = 0;
};

/// The largest error of each setting, in the order of `settings`; none for a setting that blew up. Runs the
/// reference once more, through all times at which the settings are compared.
Result<std::vector<std::optional<LargestError>>> measure_largest_errors(const scene::Scene& scene,
                                                                        const Truth& truth,
                                                                        const std::vector<Setting>& settings,
                                                                        TrialRunner& trials,
                                                                        const std::stop_token& stop);

}  // namespace clothlab::lab
