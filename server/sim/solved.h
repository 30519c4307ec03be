// How far the solves of a run's steps are from solved, under the methods that iterate. Now and then, at steps
// that depend on their numbers alone, a step is done three times more on a copy of the state: with one
// iteration less, as many, and one more. By how much an iteration still changes where the step ends, and how
// much less than the one before, gives how far the rest would go: the tail of a geometric series. The run
// itself goes on as if nothing had been measured.
#pragma once

#include <cstdint>
#include <string>

#include "server/sim/carried.h"
#include "server/sim/integrator.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

struct Kernels;

/// A warning to the user, of solves that are often unsolved, with what helps.
std::string in_words(const Solves& solves, const scene::Scene& scene);

class SolvedMeasure {
 public:
  /// True if the step after so many is measured: 8, 12, 16, 24, ..., 256 steps after `begin`, each 256 after
  /// that. So the four steps' work for one costs less than 2 % of a long run.
  bool due(std::uint64_t step) const;

  /// Measures the step that begins with `state`, of `count` vertices. All that the method's step needs must
  /// be bound; what `step` binds must be bound anew. `row`: as of Integrator::step. It may stop on its way.
  Work measure(const StateBuffers& state, Kernels& kernels, const scene::Scene& scene, int row,
               std::uint64_t step);
  /// To be called when the run begins, or what solves it is another: nothing is measured yet.
  void begin(std::uint64_t step) {
    solves_ = Solves{};
    first_step_ = step;
  }
  const Solves& solves() const { return solves_; }

 private:
  void take(const model::Model& model, const scene::Scene& scene, std::uint64_t step, bool has_fewer);

  StateBuffers trial_;
  Carried carried_;
  gl::Buffer ends_[3];  ///< places with one iteration less, as many, one more
  Solves solves_;
  std::uint64_t first_step_ = 0;
};

}  // namespace clothlab::sim
