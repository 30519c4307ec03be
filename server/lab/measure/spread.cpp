#include "server/lab/measure/spread.h"

#include <algorithm>
#include <cmath>

#include "server/base/text.h"

namespace clothlab::lab {

Spread spread_of(std::vector<double> values, double doubt) {
  Spread spread;
  const std::size_t count = values.size();
  if (count == 0) return spread;
  std::sort(values.begin(), values.end());
  spread.median = count % 2 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
  // The chance that at most k of the values are above the median: a sum of binomials.
  double chance = std::exp2(-static_cast<double>(count)), sum = chance;
  std::size_t rank = 0;  // `low` and `high` are this many values from the ends; 0: too few values
  for (std::size_t k = 0; k < count / 2 && sum <= doubt; ++k) {
    rank = k + 1;
    chance *= static_cast<double>(count - k) / static_cast<double>(k + 1);
    sum += chance;
  }
  if (rank == 0) return spread;
  spread.low = values[rank - 1];
  spread.high = values[count - rank];
  return spread;
}

std::string text(const Spread& ratio) {
  // Two decimals, or two significant digits below 0.1.
  const auto written = [](double value) {
    return value >= 0.1 ? formatted("%.2f", value) : with_significant_digits(value, 2);
  };
  if (!std::isfinite(ratio.high)) return written(ratio.median);
  return written(ratio.median) + " [" + written(ratio.low) + ".." + written(ratio.high) + "]";
}

const char* name(Saving saving) {
  switch (saving) {
    case Saving::yes:
      return "yes";
    case Saving::no:
      return "no";
    case Saving::cannot_tell:
      return "cannot tell";
    case Saving::unknown:
      break;
  }
  return "";
}

Saving saving(const Spread& ratio) {
  if (ratio.high <= largest_worthwhile_ratio) return Saving::yes;
  return ratio.low > largest_worthwhile_ratio ? Saving::no : Saving::cannot_tell;
}

namespace {

/// Fills in the ratio and the saving from the rounds in which both things were timed.
void judge(CostComparison& comparison, const std::vector<std::vector<double>>& times) {
  const std::vector<double>&candidate = times[comparison.candidate], &baseline = times[comparison.baseline];
  std::vector<double> ratios;
  for (std::size_t round = 0; round < std::min(candidate.size(), baseline.size()); ++round)
    if (std::isfinite(candidate[round]) && std::isfinite(baseline[round]) && baseline[round] > 0.0)
      ratios.push_back(candidate[round] / baseline[round]);
  comparison.ratio = spread_of(std::move(ratios), doubt_per_look);
  comparison.saving = saving(comparison.ratio);
}

}  // namespace

Result<std::vector<std::vector<double>>> take_turns(std::size_t things,
                                                    std::vector<CostComparison>& comparisons,
                                                    const std::function<Result<double>(std::size_t)>& time,
                                                    const std::function<bool()>& more) {
  std::vector<std::vector<double>> times(things);
  std::vector<bool> goes_on(things, true);
  int round = 0;
  for (const int look : rounds_at_look) {
    for (; round < look && (round < rounds_at_look[0] || more()); ++round) {
      for (std::size_t turn = 0; turn < things; ++turn) {
        const std::size_t thing = round % 2 ? things - 1 - turn : turn;
        // A thing that is decided is no longer timed: NaN holds its place, so that rounds stay aligned.
        Result<double> spent = goes_on[thing] ? time(thing) : std::nan("");
        if (!spent) return spent.error();
        times[thing].push_back(*spent);
      }
    }
    std::fill(goes_on.begin(), goes_on.end(), false);
    for (CostComparison& comparison : comparisons) {
      if (look > rounds_at_look[0] && comparison.saving != Saving::cannot_tell) continue;  // already decided
      judge(comparison, times);
      if (comparison.matters && comparison.saving == Saving::cannot_tell)
        goes_on[comparison.candidate] = goes_on[comparison.baseline] = true;
    }
    if (std::none_of(goes_on.begin(), goes_on.end(), [](bool going) { return going; }) || !more()) break;
  }
  for (std::vector<double>& own : times) std::erase_if(own, [](double spent) { return std::isnan(spent); });
  return times;
}

}  // namespace clothlab::lab
