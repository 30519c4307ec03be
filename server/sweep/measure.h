// Measures one point of a sweep on the GPU.
#pragma once

#include <list>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <string>

#include "server/lab/measure/trial.h"
#include "server/lab/measure/truth.h"
#include "server/sweep/plan.h"

namespace clothlab::sweep {

using Row = nlohmann::ordered_json;  ///< quantities by name, in the order in which they are written

struct Measured {
  Row result;         ///< see README.md here; no number in it is infinite or NaN
  std::string shape;  ///< the mesh at the end, a PLY file; empty: not asked for, or it blew up
};

/// Keeps simulations and references from one point to the next. Needs the GL context that was current when it
/// was made.
class Measurement {
 public:
  explicit Measurement(const Plan& plan) : plan_(plan) {}

  /// `scene`: plan.scene(point). Error: GL, or lab::cancelled.
  Result<Measured> measure(const scene::Document& scene, const std::stop_token& stop);

 private:
  struct Known {
    std::string key;
    lab::Truth truth;
  };
  Result<const lab::Truth*> truth_of(const scene::Document& scene, const std::stop_token& stop);
  Status add_errors(const scene::Document& scene, Row& result, const std::stop_token& stop);
  Status add_cost(const scene::Scene& scene, Row& result, const std::stop_token& stop);
  Result<std::string> add_run(const scene::Scene& scene, Row& result, const std::stop_token& stop);

  const Plan& plan_;
  lab::TrialRunner trials_;
  std::list<Known> truths_;  ///< the most recently used first
};

}  // namespace clothlab::sweep
