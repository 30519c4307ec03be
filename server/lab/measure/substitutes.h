// Simplified scenes that may stand in for a whole scene. They are measured next to it: how much each changes
// the result, how large its errors are and what it costs.
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
  std::vector<const Part*> parts;      ///< parts left out or made coarser; empty: this is the whole scene
  std::vector<glm::dvec3> at_horizon;  ///< vertices of the whole scene at compared_at() [m]; empty: unknown
  bool coarser() const;
  bool own_step() const;
  /// True if a part of it belongs to the same thing as `part`: only one of the two can be taken.
  bool excludes(const Part& part) const;
};

/// Measures a whole scene and the candidates that may stand in for it. Needs a current GL context.
class Substitutes {
 public:
  /// For `timer` see SimplifyRequest.
  Substitutes(const scene::Document& whole, const std::stop_token& stop,
              std::function<double(const scene::Scene&)> timer)
      : stop_(stop), timer_(std::move(timer)) {
    whole_.document = whole;
  }

  /// Computes the reference of the whole scene for `time` [s] and measures the whole scene. Sets `notes` to
  /// sentences for the user about what can be compared. Error: the scene cannot be built, GL, or cancelled.
  Status start(double time, const std::function<void(double share)>& progress,
               std::vector<std::string>& notes);

  /// Runs `document` as the candidate's scene and fills in the variant's patch, errors, change and step
  /// limit. With a part that has its own step, the step becomes the same share of its limit as in the whole
  /// scene. A run that blows up leaves the variant not measured, with the reason.
  Status measure(Substitute& candidate, scene::Document document);

  /// Times the candidates and the whole scene in turns; fills in their costs, and ratios to the whole's cost.
  /// Candidates whose change is at most `tolerance` get more rounds until it is clear if they save anything.
  Status time(const std::vector<Substitute*>& candidates, double tolerance);

  /// Times `candidate`, `other` and the whole scene in turns; fills in the candidate's cost and its ratio to
  /// the whole's cost. Returns its cost compared with that of `other`, a scene simplified less.
  Result<CostComparison> time_over(Substitute& candidate, const Substitute& other);

  const Substitute& whole() const { return whole_; }
  const Truth& truth() const { return truth_; }
  /// The time at which positions are compared [s]; 0: they cannot be compared.
  double compared_at() const { return truth_.why_no_reference.empty() ? truth_.horizon : without_truth_; }

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
  TrialRunner trials_;
  Truth truth_;
  Substitute whole_;
  double without_truth_ = 0;  ///< compared_at() if there is no reference [s]
};

}  // namespace clothlab::lab
