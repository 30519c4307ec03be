// The notification `colliders`: the places of the moving colliders at the time of a frame, so that clients
// need not compute the motions; and the same for recordings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "server/sim/simulation.h"

namespace clothlab::stream {

/// Of each collider that moves: its shape with the places of now, and `index`, its number in the scene. Null
/// if none does.
nlohmann::json moving_colliders(const sim::Simulation& simulation);
/// The same of colliders whose shapes are moved to where they are already.
nlohmann::json moving_colliders(const std::vector<scene::Collider>& now);

/// The notification as JSON text; empty if no collider moves.
std::string collider_text(const sim::Simulation& simulation);

}  // namespace clothlab::stream
