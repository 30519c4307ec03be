// A simulation under watch: stepped, diagnosed and judged, its last good state at hand. Whoever runs a scene
// runs it this way, so that all call the same run a blow-up and find the same remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/model/remedy.h"
#include "server/sim/blow_up.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

/// Steps and waits for the GPU; how long that took [s].
double timed_steps(Simulation& simulation, std::uint32_t count);

class GuardedRun {
 public:
  using Verdict = BlowUp::Verdict;

  /// Of a simulation that outlives it, or that `move_to` replaces; to be started before anything else.
  explicit GuardedRun(Simulation& simulation) : simulation_(&simulation) {}
  /// It goes on in another simulation, of the same state.
  void move_to(Simulation& simulation);

  /// Takes the present state for sound, whatever it is. `dt_limit` is the scene's longest stable step [s];
  /// `swing` stands for the `ratio` of the Allowance that follows from it.
  void start(double dt_limit, std::optional<double> swing = std::nullopt);
  /// The scene has changed, or its limit is known better [s].
  void allow(double dt_limit);
  /// The scene was changed under the state that was looked at last: what that added to its energy was no
  /// growth.
  void rebase();

  /// As `timed_steps`.
  double step(std::uint32_t count) { return timed_steps(*simulation_, count); }

  /// Diagnoses the present state, waiting for the GPU, and judges it; a good one is kept, to go back to.
  Verdict look();
  // The same without waiting: ask, and poll until the verdict comes.
  void ask();
  bool asked() const { return asked_; }
  std::optional<Verdict> poll();

  /// As of the last look, the start or `go_back`.
  const Diagnostics& state() const { return state_; }
  /// The last good one.
  const Diagnostics& last_good() const { return blow_up_.last_good(); }

  /// After a blow-up: what grew, from what to what, when; a sentence's first half.
  std::string reason() const { return blow_up_.reason(); }

  struct Setback {
    std::string reason;    ///< and how the step stands to its limit
    model::Remedy remedy;  ///< for it
  };
  /// After a blow-up: puts the last good state back, and says why and what to do.
  Setback go_back();

 private:
  Allowance allowance() const;
  Verdict judge(const Diagnostics& state);

  Simulation* simulation_;
  BlowUp blow_up_;
  Diagnostics state_;
  double dt_limit_ = 0;  ///< [s]
  std::optional<double> swing_;
  bool asked_ = false;
};

}  // namespace clothlab::sim
