// Scenes that stand for a whole one, measured next to it: what they change, get wrong and cost.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/lab/measure/parts.h"
#include "server/lab/measure/simplification.h"
#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"

namespace clothlab::lab {

struct Substitute {
  Variant variant;
  scene::Document document;
  std::vector<const Part*> parts;      ///< that it is without; none: the whole
  std::vector<glm::dvec3> at_horizon;  ///< [vertex of the whole] [m]; empty: not known
  bool coarser() const;
};

/// A whole scene, and the candidates to stand for it. Needs a current GL context.
class Beside {
 public:
  /// `timer` as in SimplifyRequest.
  Beside(const scene::Document& whole, const std::stop_token& stop,
         std::function<double(const scene::Scene&)> timer)
      : stop_(stop), timer_(std::move(timer)) {
    whole_.document = whole;
  }

  /// The reference of the whole for `time` [s], and the whole itself measured; `notes` say what cannot be
  /// compared. Error: the scene cannot be built, GL, or cancelled.
  Status start(double time, const std::function<void(double share)>& progress,
               std::vector<std::string>& notes);

  /// Fills in the variant's patch, errors, change and step limit; a coarser mesh takes a step that is the
  /// same share of its limit. Not measured, with the reason, where it blows up.
  Status measure(Substitute& candidate, scene::Document document);

  /// Cost and its ratio to the whole's, of these and the whole taking turns; those whose change is at most
  /// `tolerance` until it is known whether they save anything.
  Status time(const std::vector<Substitute*>& candidates, double tolerance);

  /// Cost and ratio of one more; what it costs over another of them, which it may be a further step from.
  Result<CostComparison> time_over(Substitute& candidate, const Substitute& other);

  const Substitute& whole() const { return whole_; }
  const Truth& truth() const { return truth_; }
  /// Positions are compared there [s]; 0: nowhere.
  double compared_at() const { return truth_.missing.empty() ? truth_.horizon : without_truth_; }

 private:
  Status same_share_of_limit(Substitute& candidate);
  Result<double> limit_of(const scene::Scene& scene) const;
  Status run(Substitute& candidate);
  Status compare(Substitute& candidate, const Trial& trial);
  Status compare_without_truth(std::vector<std::string>& notes);

  Result<std::vector<std::vector<double>>> turns(const std::vector<const scene::Scene*>& scenes,
                                                 std::vector<CostComparison>& comparisons);

  std::stop_token stop_;
  std::function<double(const scene::Scene&)> timer_;
  Bench bench_;
  Truth truth_;
  Substitute whole_;
  double without_truth_ = 0;  ///< where positions are compared if there is no reference [s]
};

}  // namespace clothlab::lab
