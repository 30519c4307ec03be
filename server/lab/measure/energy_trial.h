// One run of a stability map: so many steps of a scene on the GPU, judged on energy alone.
#pragma once

#include <functional>
#include <stop_token>
#include <vector>

#include "server/model/model.h"
#include "server/sim/simulation.h"

namespace clothlab::lab {

/// What a stable run may make of its energy: the same at each step and of no theory of the limit, or else the
/// map would show the theory again. A vibration at 99 % of a method's limit swings by (1 + s) / (1 - s) = 199
/// in energy without growing; what grows beyond that, and by 4 from there, does not stop.
inline constexpr double stable_swing = 199.0;
/// Powers of e by which the amplitude of an unstable vibration must grow to be seen: from what rounding to
/// float32 and a start at rest leave in it (some 1e-5 of the whole, found on the presets) to what is judged.
inline constexpr double e_folds_to_show = 11.5;

struct EnergyTrial {
  double dt = 0;         ///< [s]
  bool blew_up = false;  ///< by sim::BlowUp, or not finite
  double time = 0;       ///< simulated [s]
  double most = 0;       ///< kinetic and elastic energy, while finite [J]
  bool finite = true;
  bool touched = false;   ///< a collider or another vertex, at any look
  double max_strain = 0;  ///< at any look, while it was good
  std::string why;        ///< it blew up
};

/// Called with a good state now and then.
using AtLook = std::function<void(sim::Simulation&)>;

/// Runs `simulation`, its scene's own dt, from the start for `steps`, looking every few. Error: cancelled.
Result<EnergyTrial> run_trial(sim::Simulation& simulation, int steps, const std::stop_token& stop,
                              const AtLook& at_look = {});

}  // namespace clothlab::lab
