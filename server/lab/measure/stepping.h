// Steps a simulation in batches short enough to look at a stop token between them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "server/sim/guarded_run.h"
#include "server/sim/motion_table.h"
#include "server/sim/simulation.h"

namespace clothlab::lab {

/// Steps in batches that take about `patience` each, and adds up their wall time.
class Stepping {
 public:
  static constexpr double patience = 0.1;  ///< wall time between two looks at the stop token [s]

  explicit Stepping(sim::Simulation& simulation) : simulation_(simulation) {}
  double wall() const { return wall_; }  ///< [s]

  /// Takes one batch of at most `most` steps; returns the number of steps taken.
  std::uint32_t step(std::uint64_t most) {
    const auto count =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(most, std::max<std::uint64_t>(1, affordable_)));
    const double spent = sim::timed_steps(simulation_, count);
    wall_ += spent;
    affordable_ = static_cast<std::uint64_t>(std::clamp(patience / spent * count, 1.0, 1e6));
    return count;
  }

 private:
  sim::Simulation& simulation_;
  double wall_ = 0;
  std::uint64_t affordable_ = sim::batch_steps;
};

}  // namespace clothlab::lab
