#include "server/lab/measure/choice_words.h"

#include "server/base/text.h"
#include "server/lab/measure/step_search.h"
#include "server/model/stability.h"

namespace clothlab::lab {

namespace {

std::string times(double ratio) {
  return formatted("%.*f times", ratio < 10 ? 1 : 0, ratio);
}

}  // namespace

std::string error_text(const Point& point) {
  const std::string seen = with_significant_digits(point.largest_position_error.value_or(worst), 3);
  if (!point.error_high || with_significant_digits(*point.error_high, 3) == seen) return seen;
  return seen + " (at most " + with_significant_digits(*point.error_high, 3) + ")";
}

std::string why_chosen(const Choice& choice, const Spread& ratio_to_runner_up, bool for_margin) {
  const Point& chosen = choice.chosen;
  const double cost = chosen.cost->median;
  std::string why =
      text(chosen.setting) + " costs " + with_significant_digits(cost, 3) + " ms a simulated second";
  if (choice.runner_up) {
    const double ratio = choice.runner_up->cost->median / cost;
    const bool cheaper = ratio_to_runner_up.low > 1.0;
    why += (!cheaper       ? ", too near to tell from"
            : ratio < 1.05 ? ", about as much as"
                           : ", " + times(ratio) + " less than") +
           " the next best (" + text(choice.runner_up->setting) + ")";
  }
  const std::string below = ", where its error of " + error_text(chosen) + " is already " +
                            times(choice.tolerance / *chosen.error_high) + " below the tolerance";
  if (for_margin)
    why += "; its step is as long as holds with a margin" + below;
  else if (chosen.dt_over_limit && *chosen.dt_over_limit > model::margin_to_warn / search_precision)
    why += "; its step is as long as stability allows" + below;
  else
    why += "; with an error of " + error_text(chosen) + ", a longer step would miss the tolerance";
  if (choice.present.cost)
    why += ". The scene's own setting costs " + times(choice.present.cost->median / cost) + " as much";
  return why + ".";
}

std::string why_present(const Choice& choice) {
  const Point& present = choice.present;
  std::string why = "The scene's own setting is already the best found: " + text(present.setting) +
                    " costs " + with_significant_digits(present.cost->median, 3) +
                    " ms a simulated second, with an error of " + error_text(present) +
                    ", and nothing that keeps " + with_significant_digits(choice.tolerance, 3) +
                    " is surely cheaper";
  if (choice.runner_up) {
    const double ratio = choice.runner_up->cost->median / present.cost->median;
    why += ". The next best (" + text(choice.runner_up->setting) + ") costs " +
           (ratio < 1.05 ? "about as much" : times(ratio) + " as much") + ", with an error of " +
           error_text(*choice.runner_up);
  }
  return why + ".";
}

}  // namespace clothlab::lab
