// The lab's jobs as one type each way: what the command line, the WebSocket and the cache ask for and get.
#pragma once

#include <variant>

#include "server/lab/measure/chart.h"
#include "server/lab/measure/choice.h"
#include "server/lab/measure/simplification.h"
#include "server/lab/measure/stability_map.h"

namespace clothlab::lab {

using Job = std::variant<ChartRequest, MapRequest, ChooseRequest, SimplifyRequest>;
using Outcome = std::variant<Chart, StabilityMap, Choice, Simplification>;

/// "chart", "stability", "choose", "simplify".
const char* name(const Job& job);
const char* name(const Outcome& outcome);

/// Runs it; needs a current GL context on this thread.
Result<Outcome> run(const scene::Document& document, const Job& job, const Control<Outcome>& control);

}  // namespace clothlab::lab
