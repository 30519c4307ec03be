// The limits of a session: its scene's size, its waiting commands, and how often it checks and reports.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

#include "server/base/memory_budget.h"
#include "server/scene/ranges.h"

namespace clothlab::session {

/// The limits that `clothlab serve` sets, each with a flag.
struct Limits {
  int vertices = static_cast<int>(scene::max_vertices);      ///< at most, per scene
  int springs = 16 * static_cast<int>(scene::max_vertices);  ///< at most, per scene
  int recording_bytes = 64 << 20;  ///< at most, per recording, of which a session keeps one
  int kept_every = 1000;           ///< a state is kept for the timeline every so many steps, or sooner
  /// The process's memory, of which a session reserves what its scene takes; null: it is not bounded.
  std::shared_ptr<MemoryBudget> memory{};
  /// Memory for what a session can go back to [bytes]: half for states, a quarter for changes of the run, a
  /// quarter for undo.
  std::size_t past_bytes = 64 << 20;
  /// A change of the scene that is built within this time is not given up.
  std::chrono::milliseconds kept_building{1000};
  int unwatched_seconds = 30;  ///< without viewers for so long, a session stops stepping until one comes [s]
};

inline constexpr std::size_t max_waiting_commands = 1024;                 ///< per client
inline constexpr int commands_a_turn = 8;                                 ///< at most
inline constexpr std::chrono::milliseconds longest_commands{10};          ///< of a turn, or one command
inline constexpr double min_speed = 0.01, max_speed = 100;                ///< simulated seconds per second
inline constexpr double min_recording_rate = 1, max_recording_rate = 60;  ///< frames per second
inline constexpr std::size_t max_inspected_elements = 65536;              ///< in an answer
inline constexpr std::size_t max_inspected_contacts = 4096;               ///< in an answer
inline constexpr double inspection_rate = 20;  ///< looks at the contacts of a session that plays, per second
inline constexpr double status_rate = 10;      ///< statuses per second
inline constexpr double diagnosis_rate = 60;   ///< checks for a blow-up per second

}  // namespace clothlab::session
