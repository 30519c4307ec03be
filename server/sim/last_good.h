// Copies of the state on the GPU: of the one that is being diagnosed, and of the last one that proved good.
#pragma once

#include "server/sim/state.h"

namespace clothlab::sim {

class LastGood {
 public:
  LastGood() = default;
  explicit LastGood(std::uint32_t vertex_count);

  /// Copies the present state aside, to be kept if its diagnosis is good.
  void put_aside(const StateBuffers& state, double time, std::uint64_t step);
  /// The state put aside last becomes the good one, if it is that of `step`.
  void keep(std::uint64_t step);

  struct When {
    double time = 0;  ///< [s]
    std::uint64_t step = 0;
  };
  /// Writes the good state over the present one; when that was. There must be one.
  When restore(StateBuffers& state) const;

 private:
  struct Copy {
    gl::Buffer position, velocity;
    When when;
  };
  Copy aside_, good_;
};

}  // namespace clothlab::sim
