// Searches, for each method and number of iterations, the longest step of a scene that keeps a tolerance; a
// choice is made from the results. Candidates that are sure to cost too much to be the best or the runner-up
// are not searched.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

/// A method with its iterations and tolerance, for which the longest step that is accurate enough is
/// searched.
struct Candidate {
  Setting setting;                 ///< its dt is the longest step that may be tried
  double limit = 0;                ///< the longest stable step [s]; infinite: any step is stable
  double step_cost = 0;            ///< wall time of a step [s]
  std::optional<Point> best;       ///< at the longest step found that keeps the tolerance
  bool for_margin = false;         ///< its step was made shorter because longer ones blow up
  std::vector<double> times = {};  ///< [round] of the final timing in turns [ms per simulated second]

  double cost(double dt) const { return 1000.0 * step_cost / dt; }  ///< [ms per simulated second]
};

/// Stands for an error or a cost that is not known: worse than any.
inline constexpr double worst = std::numeric_limits<double>::infinity();
/// A candidate of at most this times the best estimated cost may turn out the cheapest when timed properly.
inline constexpr double close_race = 1.35;
/// A search ends when a step that misses the tolerance is at most this times one that keeps it.
inline constexpr double search_precision = 1.06;

class StepSearch {
 public:
  StepSearch(const scene::Scene& scene, const Truth& truth, double tolerance, TrialRunner& trials,
             std::stop_token stop)
      : scene_(scene), truth_(truth), tolerance_(tolerance), trials_(trials), stop_(std::move(stop)) {}

  /// Lists the candidates of `wanted` (empty: of all methods that suit the scene) and times each briefly.
  /// Candidates with a step limit come first, as their longest step is most often accurate already; within
  /// both groups the cheapest at its longest step comes first. Error: one of `wanted` has no meaning for the
  /// scene, no method is stable at any step, GL, or cancelled.
  Status list(const std::vector<scene::Method>& wanted);
  std::vector<Candidate>& candidates() { return candidates_; }

  /// Searches the candidate's longest step that keeps the tolerance, and fills in `best`. Gives up when the
  /// candidate can become neither the cheapest of all nor the cheapest of the methods other than the best's.
  Status search(Candidate& candidate);

  /// Runs the candidate at a step of about `dt` [s] and writes the measurements to `point`. Returns the
  /// largest position error over the cloth's size, or `worst` if the run blew up.
  Result<double> error_at(Candidate& candidate, double dt, Point& point);

  /// Runs the candidate at a step so much shorter than its best that, by the method's order, the error
  /// `too_large` should fall to the tolerance; keeps this step as the best unless the run blew up. Returns as
  /// `error_at`.
  Result<double> shorten(Candidate& candidate, double too_large);
  /// Runs the candidate at a step of about `dt` [s] and keeps it as the best unless the run blew up. Returns
  /// as `error_at`.
  Result<double> step_at(Candidate& candidate, double dt);

  /// True if a step of `dt` [s] may make the candidate the cheapest, or the cheapest of another method than
  /// that.
  bool may_compete(const Candidate& candidate, double dt) const {
    return candidate.cost(dt) <= close_race * of_interest(candidate.setting.method);
  }

  /// The method's longest stable step about the rest shape [s], exact to about 0.1 %.
  double limit_of(scene::Method method) const;

  const std::vector<Point>& tried() const { return tried_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  Status estimate_costs();
  double of_interest(scene::Method method) const;
  bool cost_bound_is_close(double most) const;
  void keep(Candidate& candidate, const Point& point) const;

  const scene::Scene& scene_;
  const Truth& truth_;
  double tolerance_;
  TrialRunner& trials_;
  std::stop_token stop_;
  std::vector<Candidate> candidates_;
  std::vector<Point> tried_;
  std::vector<std::string> notes_;
};

}  // namespace clothlab::lab
