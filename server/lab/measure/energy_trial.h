// One trial of a stability map: a scene takes a number of steps on the GPU and is judged by its energy alone.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "server/model/model.h"
#include "server/sim/simulation.h"

namespace clothlab::lab {

/// The factor by which the energy of a stable run may rise (sim::Allowance::energy_ratio). It is the same for
/// every dt and does not depend on the theoretical limit, or else the map would only show the theory again. A
/// vibration at the share s = 0.99 of its limit swings by (1 + s) / (1 - s) = 199 in energy without growing;
/// a run whose energy rises beyond this, and by another factor of 4, has blown up.
inline constexpr double stable_swing = 199.0;
/// The amplitude of an unstable vibration must grow by e to this power to be detected: from what rounding to
/// float32 and the start at rest give it (about 1e-5 of the whole, found on the presets) to a blow-up.
inline constexpr double e_folds_to_show = 11.5;

struct EnergyTrial {
  double dt = 0;         ///< [s]
  bool blew_up = false;  ///< judged by sim::BlowUp
  double time = 0;       ///< simulated [s]
  double most = 0;       ///< largest kinetic + elastic energy, while finite [J]
  bool finite = true;
  bool touched = false;   ///< true if a vertex touched a collider or another vertex at any look
  double max_strain = 0;  ///< largest strain at any look before a blow-up
  std::string why;        ///< why it blew up; empty: it did not
};

/// Called at some looks with the simulation in its present state, which has not blown up.
using AtLook = std::function<void(sim::Simulation&)>;

/// Runs `simulation` from the start for `steps` steps of its scene's own dt, and looks at its energy every
/// few steps. Error: cancelled.
Result<EnergyTrial> run_trial(sim::Simulation& simulation, int steps, const std::stop_token& stop,
                              const AtLook& at_look = {});

}  // namespace clothlab::lab
