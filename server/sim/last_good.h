// Two copies of a state on the GPU: of the state that is being diagnosed, and of the last good state.
#pragma once

#include "server/sim/state.h"

namespace clothlab::sim {

class LastGood {
 public:
  LastGood() = default;
  explicit LastGood(std::uint32_t vertex_count);

  /// Copies the shown state aside, to be kept if its diagnosis is good.
  void put_aside(const StateBuffers& state, double time, std::uint64_t step);
  /// Makes the state that was put aside last the good state, if it is the state of `step`.
  void keep(std::uint64_t step);

  struct When {
    double time = 0;  ///< [s]
    std::uint64_t step = 0;
  };
  /// Writes the good state over the present one and returns its time and step. A good state must have been
  /// kept.
  When restore(StateBuffers& state) const;

 private:
  struct Copy {
    gl::Buffer position, velocity;
    When when;
  };
  Copy aside_, good_;
};

}  // namespace clothlab::sim
