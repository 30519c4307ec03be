#include "server/lab/measure/energy_trial.h"

#include <algorithm>
#include <cmath>

#include "server/lab/measure/control.h"
#include "server/model/stability.h"
#include "server/sim/guarded_run.h"
#include "server/sim/motion_table.h"

namespace clothlab::lab {

namespace {

/// About how often a trial calls AtLook.
constexpr int calls = 20;

/// Adapts the number of steps that are queued at once to the wall time that they take, so that a cancelled
/// job ends soon even on a large cloth.
class TrialPace {
 public:
  int next() const { return count_; }
  void took(double seconds) {
    if (seconds > 0.1) count_ = std::max(1, count_ / 2);
    if (seconds < 0.03) count_ = std::min(most, count_ * 2);
  }

 private:
  static constexpr int most = sim::batch_steps / 2;
  int count_ = 1;
};

}  // namespace

Result<EnergyTrial> run_trial(sim::Simulation& simulation, int steps, const std::stop_token& stop,
                              const AtLook& at_look) {
  constexpr int look_every = sim::batch_steps / 2;
  const int looks_apart = std::max(1, steps / look_every / calls);
  simulation.reset();
  sim::GuardedRun guard(simulation);
  guard.start(model::no_limit, stable_swing);
  EnergyTrial trial;
  trial.dt = simulation.scene().solver.dt;
  TrialPace pace;
  for (int done = 0, looks = 0; done < steps;) {
    const int look_at = std::min(steps, done + look_every);
    while (done < look_at) {
      if (stop.stop_requested()) return cancelled;
      const int count = std::min(pace.next(), look_at - done);
      pace.took(guard.step(static_cast<std::uint32_t>(count)));
      done += count;
    }
    const sim::GuardedRun::Verdict verdict = guard.judge_now();
    const sim::Diagnostics& state = guard.state();
    trial.time = state.time;
    trial.touched = trial.touched || state.contacts > 0;
    const double energy = state.kinetic + state.elastic;
    if (state.finite && std::isfinite(energy)) trial.most = std::max(trial.most, energy);
    if (verdict == sim::GuardedRun::Verdict::blown_up) {
      trial.blew_up = true;
      trial.finite = state.finite && std::isfinite(energy);
      trial.why = guard.reason();
      return trial;
    }
    trial.max_strain = std::max(trial.max_strain, state.max_strain);
    if (at_look && looks++ % looks_apart == 0) at_look(simulation);
  }
  return trial;
}

}  // namespace clothlab::lab
