// The error that 32-bit floats add to the most accurate method: a line on the chart below which no shorter
// step gets.
#pragma once

#include <optional>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

/// RMS distance at the horizon, over the cloth's size, between RK4 on the GPU and RK4 in double precision
/// with the same step of at most `dt` [s]. None: the run in double precision takes longer than `budget` [s]
/// of wall time, or the run on the GPU blows up. Error: GL, or cancelled.
Result<std::optional<double>> float32_floor(const scene::Scene& scene, const Truth& truth, double dt,
                                            double budget, TrialRunner& trials, const std::stop_token& stop);

}  // namespace clothlab::lab
