// What a session is brought back from after its end, its thread's or its process's: its scene, where it was
// and how it went on.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "server/base/result.h"
#include "server/sim/simulation.h"

namespace clothlab::session {

using nlohmann::json;

struct Saved {
  json document;  ///< as scene.get tells it
  std::uint64_t revision = 1;
  bool playing = true;
  double speed = 1;
  double time = 0;  ///< [s]
  std::uint64_t step = 0;
  sim::State state;
};

/// A line that says what this is, a line of JSON, and the state's floats (little-endian).
std::string to_bytes(const Saved& saved);
/// Error: what of it is not as to_bytes writes it; the state is checked by its hash.
Result<Saved> saved_from(const std::string& bytes);

}  // namespace clothlab::session
