// The notification `colliders`: where those that move are at the time of a frame. No client repeats a law of
// motion.
#pragma once

#include <string>

#include "server/sim/simulation.h"

namespace clothlab::stream {

/// Empty where none moves.
std::string collider_text(const sim::Simulation& simulation);

}  // namespace clothlab::stream
