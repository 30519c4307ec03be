// The position errors of settings at every step, or nearly: what a choice may promise. A search looks at the
// few times that its runs and the reference have in common, 4 of them where steps are long; the largest error
// may lie between.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "server/lab/measure/setting.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"

namespace clothlab::lab {

/// The largest position error up to the horizon, over the cloth's size. It is no more than `high`: to what
/// was seen comes half of the largest change from one look to the next, where there are steps between, and
/// the reference's own error; and no less than `low`.
struct LargestError {
  double seen = 0, low = 0, high = 0;
};

/// By setting; none where it blew up. The reference goes once more, through all the times that are looked at.
Result<std::vector<std::optional<LargestError>>> look_again(const scene::Scene& scene, const Truth& truth,
                                                            const std::vector<Setting>& settings,
                                                            Bench& bench, const std::stop_token& stop);

}  // namespace clothlab::lab
