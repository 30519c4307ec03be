// One way of advancing the state by a step on the GPU. Each family of methods is one file: whole_step.cpp
// (one dispatch a step), rk4.cpp, implicit_euler.cpp, gauss_seidel.cpp.
#pragma once

#include <cstdint>
#include <memory>

#include "server/base/result.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/motion_table.h"
#include "server/sim/plan.h"
#include "server/sim/self_collision.h"
#include "server/sim/state.h"
#include "server/sim/work.h"

namespace clothlab::sim {

/// What a step depends on besides the state.
struct Surroundings {
  const scene::Scene& scene;
  const model::Model& model;
  const MotionTable& motions;
  const SelfCollision* self_collision;  ///< null without
};

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Takes over what may change without new kernels.
  virtual void set_parameters(const Surroundings& around) = 0;

  /// One step: reads the state, writes its other copy, swaps the two. `row` is the step's first in the pose
  /// table. Springs, slices, rest positions, poses and neighbour lists must be bound. A step of many
  /// dispatches may stop between them; the state must outlive it.
  virtual Work step(StateBuffers& state, int row) = 0;

  /// The state was not made by this object's last step, or that was given up half-way: forget what was
  /// carried over from it.
  virtual void restart() {}

  virtual SolverWork work() const { return {}; }

  /// Dispatches queued since it was made.
  std::uint64_t dispatches() const { return dispatches_; }

 protected:
  void dispatch(GLuint groups) {
    glDispatchCompute(groups, 1, 1);
    ++dispatches_;
  }
  std::uint64_t dispatches_ = 0;
};

/// The one that the scene's solver names, its parameters set.
Result<std::unique_ptr<Integrator>> make_integrator(const Surroundings& around, const Plan& plan);

/// The families, for make_integrator.
Result<std::unique_ptr<Integrator>> make_whole_step(scene::Method method, std::uint32_t vertex_count,
                                                    const Plan& plan);
Result<std::unique_ptr<Integrator>> make_rk4(std::uint32_t vertex_count, const Plan& plan);
Result<std::unique_ptr<Integrator>> make_implicit_euler(std::uint32_t vertex_count, const Plan& plan);
Result<std::unique_ptr<Integrator>> make_gauss_seidel(const Surroundings& around, const Plan& plan);

/// What the kernels so far have written is there for the next one to read, for indirect dispatches and for
/// copies.
inline void wait_for_writes() {
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT);
}

/// Sets the uniforms that the kernels of all methods share, where the program has them.
void set_step_uniforms(const gl::Program& program, const Surroundings& around);

}  // namespace clothlab::sim
