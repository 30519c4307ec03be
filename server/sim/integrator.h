// A method that advances the state by one step on the GPU. Each family of methods is one file: whole_step.cpp
// (one dispatch a step), rk4.cpp, implicit_euler.cpp (with implicit_passes.h, bdf2.h), gauss_seidel.cpp.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "server/base/result.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/carried.h"
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
  const SelfCollision* self_collision;  ///< null if the scene has none
};

class SurfaceContact;

class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Takes over the numbers of the scene, which may change without new kernels.
  virtual void set_parameters(const Surroundings& around) = 0;
  /// The same where only numbers of forces and contacts differ: gravity, drag of the air, wind, friction,
  /// restitution.
  virtual void set_numbers(const Surroundings& around) { set_parameters(around); }

  /// Does one step: reads the present copy of the state, writes the other copy, swaps the two. `row`: row of
  /// the step's start in the pose table. The element lists, their slices, rest positions, poses and neighbour
  /// lists must be bound. A step of many dispatches may stop between them; `state` must outlive the step.
  virtual Work step(StateBuffers& state, int row) = 0;

  /// To be called before a step: where contact between surfaces is a term of the step's problem, what knows
  /// it.
  void set_contact(SurfaceContact* contact) { contact_ = contact; }
  /// Called by a method that evaluates forces at several times of a step, before each: which share of the
  /// step has passed. Such a method's parameters may be set then.
  void set_stage_watch(std::function<void(double share)> watch) { at_stage_ = std::move(watch); }

  /// To be called before a step: whether hands hold the cloth in it (hands.h).
  void set_held(bool held) { held_ = held; }

  /// Forgets what was carried over from the last step. To be called if the present state was not made by this
  /// object's last step, or if that step was given up half-way.
  virtual void restart() {}

  /// Names what the next step needs of the last one, besides the state. It must be all of it.
  virtual void carry(Carrier&) {}

  /// Of methods that iterate: the iterations of a step, at most; else 0.
  virtual int iterations() const { return 0; }
  /// A step as `step` does, which is not counted. For methods that iterate.
  virtual Work again(StateBuffers&, int /*row*/) { return {}; }
  /// How far `solve` goes: Newton steps at most, and the relative residual that a linear solve may leave.
  struct Precision {
    int newton_steps = 1;
    double tolerance = 0;
  };
  /// A step to another precision, which is not counted either. `spent`: its work. For methods that solve
  /// equations.
  virtual Work solve(StateBuffers&, int /*row*/, const Precision&, SolverWork& /*spent*/) { return {}; }

  virtual SolverWork work() const { return {}; }

  /// Number of dispatches queued since this object was made.
  std::uint64_t dispatches() const { return dispatches_; }

 protected:
  void dispatch(GLuint groups) {
    glDispatchCompute(groups, 1, 1);
    ++dispatches_;
  }
  std::uint64_t dispatches_ = 0;
  SurfaceContact* contact_ = nullptr;
  bool held_ = false;
  std::function<void(double share)> at_stage_;
};

/// Makes the integrator for the scene's method and sets its parameters.
Result<std::unique_ptr<Integrator>> make_integrator(const Surroundings& around, const Plan& plan);

/// Make an integrator of one family; make_integrator calls these functions.
Result<std::unique_ptr<Integrator>> make_whole_step(scene::Method method, std::uint32_t vertex_count,
                                                    const Plan& plan);
Result<std::unique_ptr<Integrator>> make_rk4(std::uint32_t vertex_count, const Plan& plan);
Result<std::unique_ptr<Integrator>> make_implicit_euler(const model::Model& model, const Plan& plan);
Result<std::unique_ptr<Integrator>> make_gauss_seidel(const Surroundings& around, const Plan& plan);

/// Makes everything that the kernels queued so far write visible to the next kernels, to indirect dispatches
/// and to copies.
inline void wait_for_writes() {
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT |
                  GL_BUFFER_UPDATE_BARRIER_BIT | GL_UNIFORM_BARRIER_BIT);
}

/// Sets those of the uniforms shared by the kernels of all methods that `program` has.
void set_step_uniforms(const gl::Program& program, const Surroundings& around);

}  // namespace clothlab::sim
