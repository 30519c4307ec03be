// Scenes that stand for a whole one, measured next to it: what they change, get wrong and cost.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "server/lab/parts.h"
#include "server/lab/simplification.h"
#include "server/lab/trial.h"
#include "server/lab/truth.h"

namespace clothlab::lab {

struct Candidate {
  Variant variant;
  scene::Document document;
  std::vector<const Part*> parts;      ///< that it is without; none: the whole
  std::vector<glm::dvec3> at_horizon;  ///< [vertex of the whole] [m]; empty: not known
  bool coarser() const;
};

/// A whole scene, and the candidates to stand for it. Needs a current GL context.
class Beside {
 public:
  Beside(const scene::Document& whole, const std::stop_token& stop) : stop_(stop) { whole_.document = whole; }

  /// The reference of the whole for `time` [s], and the whole itself measured; `notes` say what cannot be
  /// compared. Error: the scene cannot be built, GL, or cancelled.
  Status start(double time, const std::function<void(double share)>& progress,
               std::vector<std::string>& notes);

  /// Fills in the variant's patch, errors, change and step limit; a coarser mesh takes a step that is the
  /// same share of its limit. Not measured, with the reason, where it blows up.
  Status measure(Candidate& candidate, scene::Document document);

  /// Cost and its ratio to the whole's, of these and the whole taking turns.
  Status time(const std::vector<Candidate*>& candidates);

  const Candidate& whole() const { return whole_; }
  const Truth& truth() const { return truth_; }
  /// Positions are compared there [s]; 0: nowhere.
  double compared_at() const { return truth_.missing.empty() ? truth_.horizon : without_truth_; }

 private:
  Status same_share_of_limit(Candidate& candidate);
  Result<double> limit_of(const scene::Scene& scene) const;
  Status run(Candidate& candidate);
  Status compare(Candidate& candidate, const Trial& trial);
  Status compare_without_truth(std::vector<std::string>& notes);

  std::stop_token stop_;
  Bench bench_;
  Truth truth_;
  Candidate whole_;
  double without_truth_ = 0;  ///< where positions are compared if there is no reference [s]
};

}  // namespace clothlab::lab
