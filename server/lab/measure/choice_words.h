// What a choice of setting says to the user.
#pragma once

#include <string>

#include "server/lab/measure/choice.h"
#include "server/lab/measure/spread.h"

namespace clothlab::lab {

/// The error seen and, if it differs, its upper bound: "0.00034 (at most 0.00036)".
std::string error_text(const Point& point);

/// Why the chosen setting was chosen, in a sentence or two; `ratio_to_runner_up`: the runner-up's cost over
/// its own, timed in turns. `for_margin`: its step was made shorter because longer ones blow up.
std::string why_chosen(const Choice& choice, const Spread& ratio_to_runner_up, bool for_margin);

/// Why the scene's own setting stays, in a sentence or two.
std::string why_present(const Choice& choice);

}  // namespace clothlab::lab
