// The bounds of a session: of its scene, of what may wait for it, and how often it looks and tells.
#pragma once

#include <cstddef>

#include "server/scene/ranges.h"

namespace clothlab::session {

/// What whoever starts the server may set: one flag of `clothlab serve` each.
struct Limits {
  int vertices = static_cast<int>(scene::max_vertices);  ///< of a scene
  int springs = 16 * static_cast<int>(scene::max_vertices);
};

inline constexpr std::size_t max_waiting_commands = 1024;   ///< of a client
inline constexpr double min_speed = 0.01, max_speed = 100;  ///< simulated seconds a second
inline constexpr double status_rate = 10;                   ///< statuses a second
inline constexpr double diagnosis_rate = 60;                ///< looks a second at whether it blows up
/// A session that nobody has watched for this long stops stepping until somebody does again [s].
inline constexpr double unwatched_seconds = 30;

}  // namespace clothlab::session
