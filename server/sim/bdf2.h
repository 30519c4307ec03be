// What BDF2 (shaders/methods/bdf2.glsl) has beside implicit Euler, whose passes do its steps: the way and
// gain of velocity of the last step, and whether the next one may use them. It may where the motion was
// smooth: not after a start, another dt, a hand that held the cloth, or a contact that began.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/carried.h"
#include "server/sim/integrator.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"

namespace clothlab::sim {

class Bdf2 {
 public:
  /// `defines`: of the kernels of implicit Euler.
  static Result<Bdf2> create(const model::Model& model, const Plan& plan, const gl::Defines& defines);

  void set_parameters(const Surroundings& around);

  /// To be called when a step begins. `held`: hands hold the cloth, as springs of implicit Euler's step.
  void begin(bool held);
  /// Does the step that begins anew, by implicit Euler. False: it was that already.
  bool begin_by_implicit_euler();
  /// Whether the step under way is by the formula of BDF2, else by implicit Euler.
  bool by_formula() const { return by_formula_; }
  /// The time in the equations of the step under way in place of its length [s].
  double dt() const { return (by_formula_ ? 2.0 / 3.0 : 1.0) * step_length_; }
  double step_length() const { return step_length_; }

  /// Keeps what a step changes besides the state, so that `put_back` can begin it anew.
  void put_aside(const std::vector<const gl::Buffer*>& changed);
  void put_back(const std::vector<gl::Buffer*>& changed) const;

  /// Binds and sets what the program needs that sets up a step.
  void bind_begin(const gl::Program& start) const;
  /// Writes the state in which the wind is taken.
  void expect(const gl::TextureBuffer& position, const gl::TextureBuffer& velocity) const;
  /// To be called when the step's end is in the other copy of the state. Returns true if the motion was not
  /// smooth in it: contact began, or the wind took a vertex along. Waits for the GPU where it may be so. The
  /// pairs that press must be bound. `row`: of the table of motions, at the step's start.
  bool look(const StateBuffers& state, const gl::TextureBuffer& wind_loads, int row);
  /// Takes over the step that `look` saw. `smooth`: the next one may use it.
  void accept(bool smooth);

  void restart();
  void carry(Carrier& carrier);

 private:
  GLuint groups_ = 0;
  bool may_meet_ = false;  ///< something from which on the motion is not smooth
  double step_length_ = 0;
  bool holds_ = false;       ///< the history, for the next step
  bool held_ = false;        ///< hands hold the cloth in the step under way
  bool by_formula_ = false;  ///< the step under way
  bool last_by_formula_ = false;
  std::array<gl::TextureBuffer, 2> history_;  ///< the first of the last step, the other of the one under way
  gl::Buffer met_;
  std::vector<gl::Buffer> aside_;
  gl::Program keep_, expect_;  ///< the second only with wind
};

}  // namespace clothlab::sim
