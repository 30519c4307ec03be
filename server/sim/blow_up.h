// Detects from a run's energies that it is blowing up: kinetic and elastic energy grow by more than the work
// done on the cloth, gravity's included. Plain arithmetic on the diagnostics of state after state; no GL.
#pragma once

#include <string>

#include "server/sim/simulation.h"

namespace clothlab::sim {

/// How far the energy of a scene's run may change without being a blow-up.
struct Allowance {
  double slack_energy = 0;     ///< energy [J] allowed beyond `energy_ratio`
  double energy_ratio = 2;     ///< largest kinetic + elastic energy, over what the ledger leaves for them
  double growth = 4;           ///< factor of growth that turns a doubt into a blow-up; 1 if dt > dt_limit
  double pin_speed = 0;        ///< speed of the fastest pin [m/s]
  double collider_speed = 0;   ///< speed of the fastest point of a collider near the cloth [m/s]
  double wind_power = 0;       ///< the most that the wind does [W]
  double weight = 0;           ///< where gravity changes by keys: the most that the cloths weigh [N]; else 0
  double hand_force = 0;       ///< the most that hands pull with [N]
  double hand_reach = 0;       ///< the way over which such a pull sets a vertex going [m]
  bool counts_elastic = true;  ///< true if growth of elastic energy counts, false if only kinetic energy does
};

/// The allowance for a scene. `slack_energy` is the scene's own scale of energy, a sum over its cloths: to
/// lift each by a quarter of its size; to move it at twice the speed of its pins and of the colliders, and at
/// the wind's; to stretch each element by a thousandth of its size, by the push of self-collision in a step
/// and by the rounding of float32. `energy_ratio` is how far the energy of a stable vibration varies under
/// symplectic Euler, (1 + s) / (1 - s) with s = dt / dt_limit, and at least 2. `counts_elastic` is false for
/// methods that sweep (PBD, XPBD, VBD): with too few sweeps the cloth stretches far, and its full stiffness
/// then gives an elastic energy that no work has put in. That is no blow-up.
Allowance allowance(const scene::Scene& scene, const model::Model& model, double dt_limit);

/// True if a change of scene may change the energy of a state. A change of the solver (e.g. of dt) cannot.
bool changes_energy(const scene::Scene& from, scene::Scene to);

/// Keeps a ledger: the total energy at the start, plus the work that pins, colliders and wind may have done
/// since, less the energy lost. What the ledger leaves for kinetic and elastic energy is the ledger less the
/// gravitational energy. A run is in doubt if those two exceed `energy_ratio` times that, plus
/// `slack_energy`. The run has blown up if they then grow by the factor `growth`. After a single jump (a
/// collider put into the cloth) they do not grow further, and after a while the run is good again.
class BlowUp {
 public:
  enum class Verdict {
    good,      ///< the run may later go back to this state
    doubtful,  ///< the run goes on, but this state must not be kept to go back to
    blown_up,
    unjudged  ///< only looked at: of a GuardedRun that judges at other steps
  };

  /// Begins a new ledger with `state`, which counts as good whatever it is.
  void start(const Allowance& allowance, const Diagnostics& diagnosis);
  /// To be called after a change of scene, before the next step. `state`: diagnosis, under the new scene, of
  /// the state that was judged last. The energy that the change added does not count as growth.
  void rebase(const Diagnostics& diagnosis);
  void set_allowance(const Allowance& allowance) { allowance_ = allowance; }
  /// Judges a state. States must come in the order of time.
  Verdict judge(const Diagnostics& diagnosis);

  /// After `blown_up`: the first half of a sentence that says which energy grew, between which values and
  /// times.
  std::string reason() const;
  /// What is compared in the state that was judged last.
  struct Energy {
    double allowed = 0;           ///< the most with which it would not have been in doubt [J]
    double found = 0;             ///< [J]
    double time = 0;              ///< of that state [s]
    bool counts_elastic = false;  ///< both are of kinetic and elastic energy; else of kinetic energy alone
  };
  Energy energy() const { return {allowed_, growing_energy(last_), last_.time, allowance_.counts_elastic}; }
  const Diagnostics& last_good() const { return last_good_; }

 private:
  double work_since_last(const Diagnostics& state) const;
  Verdict judge_doubtful(const Diagnostics& state);
  /// Gravity that changes has no energy: it does work, as the wind does.
  Diagnostics seen(Diagnostics state) const {
    if (allowance_.weight > 0.0) state.gravitational = 0.0;
    return state;
  }
  double growing_energy(const Diagnostics& state) const {
    return state.kinetic + (allowance_.counts_elastic ? state.elastic : 0.0);
  }

  Allowance allowance_;
  double ledger_ = 0;          ///< [J]
  double allowed_ = 0;         ///< Energy::allowed
  double work_ = 0;            ///< work done since the last good state [J]
  double doubted_energy_ = 0;  ///< growing_energy when the doubt began [J]; 0: no doubt
  int doubted_for_ = 0;        ///< number of judgements since the doubt began or was last reviewed
  Diagnostics last_, last_good_;
};

}  // namespace clothlab::sim
