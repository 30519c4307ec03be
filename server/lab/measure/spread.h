// What repeated timings can tell: a median with an interval that contains it, whatever the distribution of
// the noise, and whether one thing costs less than another by more than the noise.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace clothlab::lab {

struct Spread {
  double median = 1;
  double low = 0, high = std::numeric_limits<double>::infinity();  ///< 0 and infinite: too few values to tell
};

/// The median of `values`, and two of the values, `low` and `high`, as an interval for the median of the
/// distribution they come from: that median is above `high` with a chance of at most `doubt`, and below `low`
/// likewise. (Each value is above that median with a chance of a half, so the number of values above it is
/// binomial.)
Spread spread_of(std::vector<double> values, double doubt);

/// "0.97 [0.85..1.08]", or only the median where there are too few values for an interval.
std::string text(const Spread& ratio);

enum class Saving {
  unknown,     ///< not timed
  yes,         ///< the whole interval of the costs' ratio is at most `largest_worthwhile_ratio`
  no,          ///< the whole interval is above `largest_worthwhile_ratio`
  cannot_tell  ///< `largest_worthwhile_ratio` lies within the interval
};
const char* name(Saving saving);  ///< "", "yes", "no", "cannot tell"

/// The largest ratio of costs that counts as a saving: a smaller saving is not worth a change of the model.
inline constexpr double largest_worthwhile_ratio = 0.95;
/// The verdict on a measured ratio of costs: `yes` or `no` only if the whole interval says so.
Saving saving(const Spread& ratio);

/// The largest chance that any comparison behind a recommendation wrongly finds a saving, and the largest
/// number of these comparisons: 9 parts against the whole scene at most, 8 combinations of parts against
/// smaller ones.
inline constexpr double most_doubt = 0.01;
inline constexpr int most_comparisons = 17;
/// Numbers of rounds after which the timings are judged. After 13 rounds the interval reaches from the
/// smallest to the largest ratio: all 13 are above the median (or all below) with a chance of 1.2e-4.
inline constexpr int rounds_at_look[] = {13, 26, 52};
inline constexpr double doubt_per_look = most_doubt / (most_comparisons * 3);

/// A comparison of the costs of two things.
struct CostComparison {
  std::size_t candidate = 0, baseline = 0;  ///< indices of the two things
  bool matters = true;                      ///< true: rounds are added until the comparison is decided
  Spread ratio = {};                        ///< the cost of `candidate` over that of `baseline`
  Saving saving = Saving::unknown;
};

/// Times the things 0 to `things` - 1 in turns, each once a round, and fills in `comparisons`. Every other
/// round goes in the opposite order, so that a machine that becomes slower favours no thing; each ratio is
/// taken within one round. `time` times one thing once; `more` returns true while there is time for further
/// rounds. Returns the times, [thing][round].
Result<std::vector<std::vector<double>>> take_turns(std::size_t things,
                                                    std::vector<CostComparison>& comparisons,
                                                    const std::function<Result<double>(std::size_t)>& time,
                                                    const std::function<bool()>& more);

}  // namespace clothlab::lab
