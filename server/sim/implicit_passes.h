// The passes of implicit Euler's step before and after its solves (shaders/methods/implicit_*.comp), their
// programs and buffers. implicit_euler.cpp has the order in which a step does them.
#pragma once

#include <optional>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/sim/bdf2.h"
#include "server/sim/carried.h"
#include "server/sim/conjugate_gradients.h"
#include "server/sim/integrator.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"

namespace clothlab::sim {

class ImplicitPasses : public Integrator {
 public:
  /// Takes over the numbers of the scene. Another length of the step forgets the last steps.
  void set_parameters(const Surroundings& around) override;
  /// Forgets the past velocities and all contacts with colliders.
  void restart() override;
  void carry(Carrier& carrier) override;

 protected:
  ImplicitPasses(const model::Model& model, const Plan& plan);
  /// Compiles the programs that the scene needs.
  Status load(const model::Model& model, const Plan& plan);

  void run(const gl::Program& program);
  /// Takes the wind, finds what pins and solids hold, and makes the first estimate and guess.
  void begin(StateBuffers& state, int row);
  /// Makes the velocity at the step's start the first estimate, or the share of it that a line search finds
  /// best.
  void begin_with_velocity();
  /// Binds the state in which BDF2 takes the wind.
  void expect();
  /// Binds what all passes read.
  void bind_inputs(const StateBuffers& state);
  /// Binds the buffers that the passes before and after a solve write.
  void bind_estimate();
  /// Sets up the linear system at the present estimate. `first` in the time step; `exact`: the estimate is
  /// the state at the step's start.
  void set_up(bool first, bool exact);
  /// Adds to the first guess what the last steps' velocities tell of this one's.
  void improve_guess();
  /// Does the line search along a change.
  void search(const gl::TextureBuffer& change);
  /// Adds the share of the solved change that the line search found best to the estimate. `another`: a
  /// further Newton step may follow in this time step.
  void advance(int row, bool another);
  /// Does the passes of self-collision. Each pass reads the velocities from one of two buffers and writes
  /// them to the other; after an even number of passes they are in `velocity_` again.
  void keep_apart();
  /// Writes the state at the step's end to the other copy.
  void finish(StateBuffers& state, const gl::TextureBuffer& residual, int row);
  /// Gives BDF2's equations their time in place of the step's length.
  void set_equation_time();

  GLuint groups_;
  bool touches_;  ///< whether vertices may be kept at solids, which then press them by no force
  ConjugateGradients solver_;
  std::optional<Bdf2> bdf2_;  ///< none: implicit Euler
  double dt_ = 0;
  gl::Program start_, system_, project_, improve_, search_, advance_, end_;
  gl::Program choose_;                                 ///< none without contact in the problem
  gl::Program first_;                                  ///< none with it
  gl::Program contacts_, wind_;                        ///< none if the scene has no self-collision, no wind
  gl::TextureBuffer start_position_, start_velocity_;  ///< state at the step's start, after self-collision
  gl::TextureBuffer position_, velocity_;              ///< estimate of the state at the step's end
  gl::TextureBuffer still_;                            ///< no velocity, for each vertex
  gl::TextureBuffer first_change_;          ///< with contact: of the estimate, before the first solve
  gl::TextureBuffer guess_;                 ///< first guess of the solved change of velocity
  gl::TextureBuffer constraint_, surface_;  ///< for each vertex: its contact with a collider
  gl::TextureBuffer wind_loads_;            ///< for each vertex: the wind at the step's start
  gl::TextureBuffer expected_position_, expected_velocity_;  ///< BDF2's, in which the wind is taken
  gl::Buffer contact_friction_;                              ///< friction of the contacts, kept between steps
  gl::TextureBuffer trends_, trend_products_;                ///< for each vertex `trends` vectors
  gl::Buffer past_velocities_;                               ///< at the starts of the last `trends` steps
  gl::TextureBuffer block_a_, block_b_;                      ///< each vertex' own block of the matrix

 private:
  Status load_own(gl::Program& program, const char* name, const gl::Defines& defines);
  std::vector<const gl::Program*> programs() const;
};

}  // namespace clothlab::sim
