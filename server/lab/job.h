// One type for all of the lab's jobs and one for all of their results, as the command line, the WebSocket and
// the cache use them.
#pragma once

#include <variant>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/choice.h"
#include "server/lab/measure/comparison.h"
#include "server/lab/measure/simplification.h"
#include "server/lab/measure/stability_map.h"

namespace clothlab::lab {

using Job = std::variant<ChartRequest, MapRequest, ChooseRequest, SimplifyRequest, CompareRequest>;
using Outcome = std::variant<Chart, StabilityMap, Choice, Simplification, Comparison>;

/// "chart", "stability", "choose", "simplify" or "compare".
const char* name(const Job& job);
const char* name(const Outcome& outcome);

/// Runs `job` on the scene `document`; needs a current GL context on this thread.
Result<Outcome> run(const scene::Document& document, const Job& job, const Control<Outcome>& control);

}  // namespace clothlab::lab
