// How far float32 may take a short run from the same run in double precision.
#pragma once

#include <vector>

#include "server/reference/reference.h"
#include "server/sim/simulation.h"

namespace clothlab::selftest {

struct Rounding {
  std::vector<double> position, velocity;  ///< [vertex_count] the usual error of one step [m], [m/s]
};

/// Of a step between two states like these, under any method.
Rounding step_rounding(const reference::World& world, const reference::State& before,
                       const reference::State& after);

/// Moves each vertex, and its velocity, by at most so much, at random. Pins stay.
void disturb(const reference::World& world, const Rounding& rounding, unsigned seed, reference::State& state);

/// A bound of the RMS distance [m] between the GPU after `steps` steps and the reference, `end`. Runs of the
/// reference are disturbed by rounding in each step, and the scene itself takes that along: through an
/// unstable shape or a contact that rounding decides, too. Ten times the farthest of them is allowed.
double allowed_distance(const reference::World& world, const reference::State& end, int steps);

/// The same for scenes that only the GPU can step, from disturbed starts: each of the steps adds as much,
/// which the scene takes along.
double allowed_distance(const reference::World& world, sim::Simulation& simulation, const sim::State& end,
                        int steps);

reference::State in_double(const sim::State& state);
/// The world of a scene as the GPU's simulation steps it.
Result<reference::World> world_of(const scene::Scene& scene);

}  // namespace clothlab::selftest
