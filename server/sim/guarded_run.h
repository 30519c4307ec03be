// Steps a simulation and watches for a blow-up: diagnoses and judges its state, and keeps the last good state
// to go back to. All parts of the program run scenes this way, so that they agree on what is a blow-up and on
// its remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/model/remedy.h"
#include "server/sim/blow_up.h"
#include "server/sim/simulation.h"

namespace clothlab::sim {

/// A run is judged after each so many steps, and at its end: 60 times a simulated second, each 32 steps at
/// least, or each 4 where the step may be near the longest stable one. By the scene alone, so that what is
/// said of a run does not depend on who looks at it.
std::uint32_t judged_every(const scene::Scene& scene, const model::Model& model);

/// Does `count` steps and waits for the GPU. Returns the time that this took [s], without what measures how
/// far steps are from solved.
double timed_steps(Simulation& simulation, std::uint32_t count);

class GuardedRun {
 public:
  using Verdict = BlowUp::Verdict;

  /// `simulation` must live until this object ends or `move_to` replaces it. Call `start` first.
  explicit GuardedRun(Simulation& simulation) : simulation_(&simulation) {}
  /// Continues with another simulation, which must have the same state.
  void move_to(Simulation& simulation);

  /// Takes the present state as good, whatever it is. `dt_limit` is the scene's longest stable step [s].
  /// `swing`, if given, replaces the `energy_ratio` of the Allowance that follows from `dt_limit`.
  void start(double dt_limit, std::optional<double> swing = std::nullopt);
  /// To be called when the scene has changed or its longest stable step `dt_limit` [s] is known better.
  void set_dt_limit(double dt_limit);
  /// From now on only states after each `steps` steps are judged, each of them, whenever and however often
  /// the run is looked at: the simulation asks for their diagnoses itself. 0: whatever is asked for is
  /// judged.
  void judge_every(std::uint32_t steps);
  /// To be called when other hands hold the cloth: the most that they pull with [N], and over which way that
  /// sets a vertex going [m] (model::Hold). What held since the last judgement counts in the next one.
  void set_hands(double force, double reach);
  /// To be called after a judgement and a change of scene, with no step between: the energy that the change
  /// added does not count as growth.
  void rebase();

  /// Calls `timed_steps`.
  double step(std::uint32_t count) { return timed_steps(*simulation_, count); }

  /// Diagnoses the present state, waiting for the GPU, and judges it, after what is still to be judged. A
  /// good state is kept, to go back to.
  Verdict judge_now();
  /// Only diagnoses the present state, waiting for the GPU.
  void look();
  // `judge_now` without waiting for the GPU: call `request_verdict`, then `poll_verdict` until it returns a
  // verdict. It also returns, in order, those of the states of `judge_every`, which nobody need request.
  void request_verdict();
  bool verdict_requested() const { return verdict_requested_; }
  std::optional<Verdict> poll_verdict();

  /// The diagnosis of the state that was judged, started from or gone back to last.
  const Diagnostics& state() const { return state_; }
  /// The diagnosis of the last good state.
  const Diagnostics& last_good() const { return blow_up_.last_good(); }

  /// After a blow-up: BlowUp::reason.
  std::string reason() const { return blow_up_.reason(); }

  struct Setback {
    std::string reason;       ///< which energy grew, and how dt compares with dt_limit
    model::Remedy remedy;     ///< what to change in the scene
    BlowUp::Energy energy{};  ///< of the state that was judged last
  };
  /// After a blow-up: puts the last good state back. Returns why, and what to change.
  Setback go_back();

 private:
  Allowance allowance() const;
  Verdict judge(const Diagnostics& state);
  Verdict take(const Diagnostics& state);

  Simulation* simulation_;
  BlowUp blow_up_;
  Diagnostics state_;
  double dt_limit_ = 0;  ///< [s]
  std::optional<double> swing_;
  struct Pull {
    double force = 0, reach = 0;
  } pull_, pull_before_;  ///< of the hands now, and at most since the last judgement
  bool verdict_requested_ = false;
  std::uint64_t requested_step_ = 0;
  std::uint32_t every_ = 0;
  std::uint64_t judged_step_ = 0;  ///< the last of `judge_every`
};

}  // namespace clothlab::sim
