// What repeated timings can tell: a median with the interval that holds it, whatever the law of the noise,
// and whether one thing costs less than another by more than that.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::lab {

struct Spread {
  double median = 1;
  double low = 0, high = std::numeric_limits<double>::infinity();  ///< 0 and infinite: too few to tell
};

/// The median of what the values are drawn from lies between two of them, `low` and `high`: it is above
/// `high` with a chance of at most `doubt`, and below `low` likewise. (Each value is above it with a chance
/// of a half, so how many are is a matter of counting.)
Spread spread_of(std::vector<double> values, double doubt);

/// "0.97 [0.85..1.08]"; without an interval where there is none.
std::string text(const Spread& ratio);

enum class Saving {
  unknown,     ///< not timed
  yes,         ///< costs less than `worth_it` of the other
  no,          ///< costs more than that
  cannot_tell  ///< within the noise
};
const char* name(Saving saving);  ///< "", "yes", "no", "cannot tell"

/// Of the other's cost: what saves less is not worth a change of the model.
inline constexpr double worth_it = 0.95;
/// What can be said of costs whose ratio was measured as this.
Saving saving(const Spread& ratio);

/// How often a recommendation may save nothing, over all its comparisons, of which there are at most so many.
inline constexpr double most_doubt = 0.01;
inline constexpr int most_comparisons = 11;
/// Rounds after which is looked whether it is decided. After the first, the interval is from the least to the
/// most: all of 12 on one side come with a chance of 2.4e-4.
inline constexpr int looks[] = {12, 24, 48};
inline constexpr double doubt_a_look = most_doubt / (most_comparisons * 3);

/// One thing's cost over another's.
struct CostComparison {
  std::size_t thing = 0, over = 0;
  bool matters = true;  ///< rounds are added until it is decided
  Spread ratio = {};
  Saving saving = Saving::unknown;
};

/// Times `things`, all in each round and in turns, every other round in the opposite order, so that a machine
/// that grows slower flatters none; a ratio is of one round. `time` times one thing once; `more` says whether
/// there is time left. Fills in the comparisons. [thing][round]
Result<std::vector<std::vector<double>>> take_turns(std::size_t things,
                                                    std::vector<CostComparison>& comparisons,
                                                    const std::function<Result<double>(std::size_t)>& time,
                                                    const std::function<bool()>& more);

}  // namespace clothlab::lab
