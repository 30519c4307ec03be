// Whether a run is blowing up, told from its energies: kinetic and elastic energy that grow although nobody
// does the work. Plain arithmetic on diagnostics, frame after frame; no GL.
#pragma once

#include <string>

#include "server/sim/simulation.h"

namespace clothlab::sim {

/// What an honest run of a scene may do to its energy.
struct Allowance {
  double slack = 0;           ///< [J]
  double ratio = 2;           ///< kinetic + elastic energy over what is there for them
  double growth = 4;          ///< from where a doubt begins to where it is proved; 1 beyond the step limit
  double pin_speed = 0;       ///< of the fastest pin [m/s]
  double collider_speed = 0;  ///< of the fastest point of a collider near the cloth [m/s]
  bool stretch = true;        ///< whether elastic energy counts as growth
};

/// The slack is the scene's own scale of energy: the cloth lifted by a quarter of its size, set moving as
/// fast as what moves it, each vertex pushed as far as self-collision does in a step, and what float32 rounds
/// away. The ratio is how far the energy of a stable vibration swings under symplectic Euler at this share of
/// the step limit, (1 + s) / (1 - s) with s = dt / dt_limit. What sweeps too few times holds the cloth with
/// less than its stiffness: it stretches far, and by that stiffness with more energy than anybody gave, which
/// is no blow-up; only motion is.
Allowance allowance(const scene::Scene& scene, const model::Model& model, double dt_limit);

/// Whether a change of scene may change the energy of a state, as one of dt cannot.
bool changes_energy(const scene::Scene& from, scene::Scene to);

/// Keeps a ledger: the energy at the start, plus the work that pins and colliders may have done since, less
/// what was lost. If kinetic and elastic energy are more than `ratio` times what the ledger leaves for them,
/// and `slack`, the run is in doubt. A jump that is over (a collider put into the cloth) does not grow on;
/// one that grows by `growth` from there has blown up.
class BlowUp {
 public:
  enum class Verdict {
    good,      ///< a state to go back to
    doubtful,  ///< goes on, but is not to be kept
    blown_up
  };

  /// From `state` on, whatever it is.
  void start(const Allowance& allowance, const Diagnostics& state);
  /// The scene was changed under the state that was judged last, which has become `state`: that was no
  /// growth.
  void rebase(const Diagnostics& state);
  void allow(const Allowance& allowance) { allowance_ = allowance; }
  /// States must come in the order of time.
  Verdict judge(const Diagnostics& state);

  /// After `blown_up`: what grew, from what to what, when; a sentence's first half.
  std::string reason() const;
  const Diagnostics& last_good() const { return last_good_; }

 private:
  double work_since_last(const Diagnostics& state) const;
  Verdict doubt(const Diagnostics& state);
  double growing_energy(const Diagnostics& state) const {
    return state.kinetic + (allowance_.stretch ? state.elastic : 0.0);
  }

  Allowance allowance_;
  double ledger_ = 0;          ///< [J]
  double work_ = 0;            ///< since the last good state [J]
  double doubted_energy_ = 0;  ///< what grew when the doubt began [J]; 0: no doubt
  int doubted_for_ = 0;        ///< judgements
  Diagnostics last_, last_good_;
};

}  // namespace clothlab::sim
