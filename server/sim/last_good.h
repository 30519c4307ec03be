// Copies of states on the GPU: of those that are being diagnosed, and of the last good one.
#pragma once

#include <vector>

#include "server/sim/state.h"

namespace clothlab::sim {

class LastGood {
 public:
  LastGood() = default;
  explicit LastGood(std::uint32_t vertex_count);

  /// Copies the shown state aside, to be kept if its diagnosis is good.
  void put_aside(const StateBuffers& state, double time, std::uint64_t step);
  /// Makes the state of `step` the good state, if it was put aside.
  void keep(std::uint64_t step);
  /// To be called when no earlier state will be kept any more.
  void free_before(std::uint64_t step);

  struct When {
    double time = 0;  ///< [s]
    std::uint64_t step = 0;
  };
  /// Writes the good state over the present one and returns its time and step. A good state must have been
  /// kept.
  When restore(StateBuffers& state);

 private:
  struct Copy {
    gl::Buffer position, velocity;
    When when;
  };
  std::size_t bytes_ = 0;
  std::vector<Copy> aside_, free_;
  Copy good_;
};

}  // namespace clothlab::sim
