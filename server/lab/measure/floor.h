// What 32-bit floats take from the most accurate method: the line on the chart that no shorter step crosses.
#pragma once

#include <optional>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

/// RMS distance at the horizon, over the size, between RK4 on the GPU and RK4 in double precision with the
/// same step of at most `dt` [s]. None where the double run would take longer than `budget` [s] of wall time,
/// or the run blows up. Error: GL, or cancelled.
Result<std::optional<double>> float32_floor(const scene::Scene& scene, const Truth& truth, double dt,
                                            double budget, Bench& bench, const std::stop_token& stop);

}  // namespace clothlab::lab
