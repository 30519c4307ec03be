// The notification `colliders`: the places of the moving colliders at the time of a frame, so that clients
// need not compute the motions.
#pragma once

#include <string>

#include "server/sim/simulation.h"

namespace clothlab::stream {

/// The notification as JSON text; empty if no collider moves.
std::string collider_text(const sim::Simulation& simulation);

}  // namespace clothlab::stream
