// How far the steps of a run are from solved, under the methods that iterate, and what that is worth. All of
// them look for the end of one and the same step: that of implicit Euler with the scene's own masses and
// laws, from the state at its start. Now and then, at steps that follow from the scene and the steps before
// alone, a step is done twice more on a copy of the state: as the method does it, and solved by Newton's
// method until little is left to solve. The distance between the two is the error. The run itself goes on as
// if nothing had been measured.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/sim/carried.h"
#include "server/sim/integrator.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

struct Kernels;

/// A warning to the user, of steps that are often unsolved, with what helps.
std::string in_words(const Convergence& convergence, const scene::Scene& scene);

class ConvergenceMeasure {
 public:
  /// True if the step after so many is to be measured: the ninth since `begin`; then whenever the steps since
  /// the last one are worth 20 times what that took, by its iterations, or are three times as many as those
  /// before; and one that was asked for.
  bool due(std::uint64_t step) const { return step == asked_ || (now_and_then_ && step >= next_); }
  void ask(std::uint64_t step) { asked_ = step; }
  void measure_now_and_then(bool on) { now_and_then_ = on; }

  /// Measures the step that begins with `state`. All that the method's step needs must be bound; what `step`
  /// binds must be bound anew. `row`: as of Integrator::step. It may stop on its way.
  Work measure(const StateBuffers& state, Kernels& kernels, const scene::Scene& scene, int row,
               std::uint64_t step);
  /// To be called when the run begins, or what solves it is another: nothing is measured yet.
  void begin(std::uint64_t step);
  /// To be called with other kernels.
  void forget_solver() { solver_.reset(); }
  const Convergence& last() const { return last_; }
  /// What all measurements have taken [s].
  double seconds() const { return seconds_; }

 private:
  static constexpr std::uint64_t first_measured = 8;  ///< steps after the start

  Integrator* solver_for(Kernels& kernels, const scene::Scene& scene);
  bool take(const model::Model& model, const scene::Scene& scene, double tolerance, double newton);
  void count(std::uint64_t step, const scene::Scene& scene, const Kernels& kernels, double spent);

  StateBuffers trial_;
  Carried carried_;
  gl::Buffer places_, velocities_, end_;  ///< at the step's start, and places at its end
  std::unique_ptr<Integrator> solver_;    ///< of the step of a method that sweeps
  Plan solver_plan_;
  Convergence last_;
  std::uint64_t begun_ = 0, next_ = first_measured;  ///< steps
  std::optional<std::uint64_t> asked_;
  bool now_and_then_ = true;
  double seconds_ = 0;
};

}  // namespace clothlab::sim
