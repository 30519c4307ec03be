// How much of what a strain limit corrects in a step a cloth takes, where the limit cannot be kept: so much
// that it gives the cloth no energy. Used by the GPU's limit and by the reference's.
#pragma once

#include <vector>

#include "server/model/model.h"

namespace clothlab::model {

/// A step of all vertices, before and after the limit; each list is [vertex_count].
struct LimitedStep {
  double dt = 0;                             ///< [s]
  std::vector<double> inverse_mass;          ///< [1/kg], 0 if pinned
  std::vector<dvec3> start, start_velocity;  ///< at the step's start [m], [m/s]
  std::vector<dvec3> free, free_velocity;    ///< as the method has left them
  std::vector<dvec3> limited;                ///< places as the limit wants them [m]
};

/// The parts of its corrections that a cloth takes, 0 to 1. The velocity that goes with a correction is that
/// over dt.
struct LimitShare {
  double place = 1, velocity = 1;
};

/// For each cloth. Kinetic and elastic energy must not be more after the limit than they were before it, or
/// at the step's start if they were more there: what holds a hanging cloth only gives back what gravity gave
/// in the step. Energy is that of a traveller with the cloth's pins (their mean velocity in the step), for
/// whom pins that move alike do no work. Places come first: what was too long before the step is mended, but
/// becomes no velocity that the cloth has no energy for. Where no pin moves, all is
/// taken: the limit can be kept, if not in one step. Work against gravity counts as none: what hangs too low
/// is lifted.
std::vector<LimitShare> limit_shares(const Model& model, const LimitedStep& step);

}  // namespace clothlab::model
