// Provot's strain limit after a step of any method: shaders/strain_limit/. The sweeps end by
// the GPU's own decision; the host only asks, now and then, whether they have.
#pragma once

#include <array>
#include <cstdint>

#include "server/sim/integrator.h"

namespace clothlab::sim {

class StrainLimit {
 public:
  /// `entries`: slots of the element lists.
  static Result<StrainLimit> create(const Surroundings& around, const Plan& plan, std::size_t entries);

  void set_parameters(const Surroundings& around);

  /// Shortens what is too long in the state that a step has just made. Springs, slices and rest positions
  /// must be bound; it may stop between sweeps.
  Work apply(StateBuffers& state);

  /// The state was not made by the last step: forget what the limits pulled in it.
  void restart() { pulls_.fill(0); }

  StrainLimitWork work() const { return work_; }

 private:
  gl::Program start_, sweep_, end_;
  std::array<gl::TextureBuffer, 2> position_, group_excess_;  ///< a sweep reads one, writes the other
  gl::Buffer pulls_, given_, control_;
  double dt_ = 0;  ///< [s]
  GLuint groups_ = 0;
  StrainLimitWork work_;
};

}  // namespace clothlab::sim
