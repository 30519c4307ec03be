// The saved form of a session, from which it is restored after its thread or its process has ended: its
// scene, the cloth's state, and whether and how fast it played.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "server/base/result.h"
#include "server/sim/simulation.h"

namespace clothlab::session {

using nlohmann::json;

struct Saved {
  json document;  ///< as scene.get returns it
  std::uint64_t revision = 1;
  bool playing = true;
  double speed = 1;  ///< simulated seconds per second
  double time = 0;   ///< [s]
  std::uint64_t step = 0;
  sim::State state;
};

/// A title line with the format's version, a line of JSON, and the state's floats (little-endian).
std::string to_bytes(const Saved& saved);
/// Reads what to_bytes wrote; the state is checked by its hash. Error: where `bytes` are not of that form.
Result<Saved> saved_from(const std::string& bytes);

}  // namespace clothlab::session
