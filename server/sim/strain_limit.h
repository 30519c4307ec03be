// Provot's strain limit after a step of any method: shaders/strain_limit/. The GPU itself decides when the
// sweeps end; the host only asks, every few sweeps, if they have ended.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/sim/integrator.h"
#include "server/sim/thread_limit.h"

namespace clothlab::sim {

class StrainLimit {
 public:
  /// `entries`: number of entries in the element lists, padding included.
  static Result<StrainLimit> create(const Surroundings& around, const Plan& plan, std::size_t entries);

  void set_parameters(const Surroundings& around);

  /// Shortens the springs, and threads of triangles, that are too long in the state that a step has just
  /// made. The element lists, their slices and rest positions must be bound. The work may stop between two
  /// sweeps.
  Work apply(StateBuffers& state, const model::Model& model);

  /// Forgets the pulls of the last step. To be called if the present state was not made by that step.
  void restart();
  /// Names the pulls of the last step.
  void carry(Carrier& carrier);

  StrainLimitWork work() const { return work_; }

 private:
  /// For each cloth the parts of its corrections that it takes (model::limit_shares): of places, of
  /// velocities. `corrected`: the places after all of them. Waits for the GPU.
  std::vector<float> shares(const StateBuffers& state, const model::Model& model,
                            const gl::TextureBuffer& corrected) const;

  gl::Program start_, sweep_, end_;
  std::array<gl::TextureBuffer, 2> position_, group_excess_;  ///< a sweep reads one and writes the other
  gl::Buffer pulls_, pull_impulses_, control_;
  std::optional<ThreadLimit> threads_;  ///< if cloths of finite elements have a limit
  double dt_ = 0;                       ///< [s]
  /// The present state may be beyond its limits: the step that made it could not keep them.
  bool doubted_ = false;
  GLuint groups_ = 0;
  StrainLimitWork work_;
};

}  // namespace clothlab::sim
