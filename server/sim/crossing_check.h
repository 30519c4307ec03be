// `run --verify`: counts in double precision where cloth passes through cloth or a body of triangles, at each
// of a run's samples.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/model/crossings.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

class CrossingCheck {
 public:
  explicit CrossingCheck(const Simulation& simulation);

  /// Counts the crossings of the state at `time` [s]. A state at the time of the last one is that again.
  void add(const State& state, double time);

  /// Adds `crossings`, the largest count, and `crossing_check`, the details, to the report.
  void report(nlohmann::ordered_json& report) const;
  /// One line for the user.
  std::string in_words() const;

 private:
  struct Sample {
    double time = 0;
    std::uint64_t count = 0;
  };

  const Simulation& simulation_;
  model::Surfaces surfaces_;
  std::uint64_t samples_ = 0, crossed_ = 0;  // all, and those with crossings
  Sample last_, worst_;
  std::optional<Sample> first_;     // the first one with crossings
  std::vector<std::string> pairs_;  // of that one, the first few
};

}  // namespace clothlab::sim
