// For each method and number of iterations the longest step of a scene that keeps a tolerance: what a choice
// is made from. What is found cheap spares the search for what must be dearer.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "server/lab/measure/trial.h"

namespace clothlab::lab {

/// A method with its iterations, whose longest step that keeps the tolerance is looked for.
struct Candidate {
  Setting setting;       ///< with the longest step that may be tried
  double limit = 0;      ///< of the step [s]
  double step_cost = 0;  ///< wall time of a step [s]
  std::optional<Point> best;
  std::vector<double> times = {};  ///< of the rounds of the last race [ms per simulated second]

  double cost(double dt) const { return 1000.0 * step_cost / dt; }  ///< [ms per simulated second]
};

/// An error or a cost that is worse than any.
inline constexpr double unknown = std::numeric_limits<double>::infinity();
/// In estimated cost: who might still turn out to be the cheapest when timed properly.
inline constexpr double close_race = 1.35;
/// Between a step that keeps the tolerance and one that does not, where a search ends.
inline constexpr double near_enough = 1.06;

class StepSearch {
 public:
  StepSearch(const scene::Scene& scene, const Truth& truth, double tolerance, Bench& bench,
             std::stop_token stop)
      : scene_(scene), truth_(truth), tolerance_(tolerance), bench_(bench), stop_(std::move(stop)) {}

  /// Lists the candidates of the methods (empty: of all) and glances at what a step of each costs. Those with
  /// a step limit come first, as their longest step is most often accurate already; then those whose longest
  /// step costs least. Error: none is stable at any step, GL, or cancelled.
  Status list(std::vector<scene::Method> methods);
  std::vector<Candidate>& candidates() { return candidates_; }

  /// Looks for the candidate's longest step that keeps the tolerance, as long as it may be of interest: as
  /// cheap as the best so far, or as the best of another method.
  Status search(Candidate& candidate);

  /// Runs the candidate at a step; its largest position error, or `unknown` if it blew up. `point` gets what
  /// there is to tell.
  Result<double> error_at(Candidate& candidate, double dt, Point& point);

  /// The candidate at a step that is short enough, so it is hoped, for `too_large` to become the tolerance.
  Result<double> shorten(Candidate& candidate, double too_large);

  /// The sharp step limit about the rest shape [s].
  double limit_of(scene::Method method) const;

  const std::vector<Point>& tried() const { return tried_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  Status glance();
  double of_interest(scene::Method method) const;
  bool close_at_hand(double most) const;
  void keep(Candidate& candidate, const Point& point) const;

  const scene::Scene& scene_;
  const Truth& truth_;
  double tolerance_;
  Bench& bench_;
  std::stop_token stop_;
  std::vector<Candidate> candidates_;
  std::vector<Point> tried_;
  std::vector<std::string> notes_;
};

}  // namespace clothlab::lab
