// The linear solver of implicit Euler: conjugate gradients on the GPU with a two-level preconditioner, block
// Jacobi and the patches of coarse_level.h (shaders/methods/implicit_multiply.comp and the kernels named
// there). Vectors and sums stay on the GPU; the host asks, every few iterations, if a solve has ended.
#pragma once

#include <array>
#include <cstdint>

#include "server/base/result.h"
#include "server/sim/coarse_level.h"
#include "server/sim/integrator.h"

namespace clothlab::sim {

/// How a solve ended, and the vectors that it left.
struct Solved {
  std::uint32_t iterations = 0;
  bool converged = false;
  std::uint32_t dispatches = 0;
  const gl::TextureBuffer* change = nullptr;    ///< the solution
  const gl::TextureBuffer* residual = nullptr;  ///< what is left of the right side
  bool lost_precision = false;  ///< it ended as rounding was all that was left of the residual
};

class ConjugateGradients {
 public:
  explicit ConjugateGradients(const model::Model& model);

  /// What kernels of implicit Euler are compiled for, beside a step's.
  gl::Defines defines() const;
  /// Tells a kernel of implicit Euler how this object's buffers are laid out.
  void set_layout(const gl::Program& program) const;
  /// Loads the kernels; `defines` has those of this object, too.
  Status load(const gl::Defines& defines);
  void set_parameters(const Surroundings& around);
  /// The time in the equations, in place of the scene's dt [s]; until `set_parameters`.
  void set_dt(double dt);

  /// Binds what the kernels of a whole step read: the products and the sums of the work groups.
  void bind() const;
  /// The residual of the guess, which is to be written before `solve`.
  const gl::TextureBuffer& residual() const { return vectors_[0].residual; }
  /// The sums that each work group leaves: at most three vec4.
  const gl::TextureBuffer& sums() const { return sums_; }

  /// Makes the preconditioner's coarse level for the matrix `fine`. `contacts`: see CoarseLevel::prepare.
  void prepare(const FineLevel& fine, bool contacts) { coarse_.prepare(fine, contacts); }
  /// What ends a solve besides the tolerance, in the norm of the preconditioner, which is about the energy of
  /// the error.
  struct Enough {
    double left_share = 0;  ///< of the guess's error
    double little = 0;  ///< twice the energy of a guess that needs no solve [J], if it is in tolerance, too
  };
  /// Solves for the change of velocity from `guess` on, until the residual is as small as the tolerance asks,
  /// or the error as `enough` says. The Work fills `solved`.
  Work solve(const gl::TextureBuffer& guess, const Enough& enough, Solved& solved);

 private:
  /// The vectors that an iteration leaves to the next one.
  struct Vectors {
    gl::TextureBuffer change, residual, preconditioned, direction, direction_product;
  };

  void precondition(const Vectors& now);
  void iterate(const gl::TextureBuffer& guess, int iteration);
  void take_step(int iteration);
  void run_if_needed(const gl::Program& program, std::size_t groups);

  GLuint groups_;
  CoarseLevel coarse_;
  gl::Program collect_, precondition_, multiply_, step_, update_;
  gl::TextureBuffer product_, sums_;
  std::array<Vectors, 2> vectors_;  ///< each iteration reads one set and writes the other
  gl::Buffer control_;
  std::uint32_t dispatches_ = 0;  ///< of the present solve
};

}  // namespace clothlab::sim
