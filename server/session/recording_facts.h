// What a session has recorded, or is recording.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

namespace clothlab::session {

struct RecordingFacts {
  enum class State { none, recording, ready };
  State state = State::none;
  double rate = 0;  ///< frames a second at most [1/s]
  std::uint32_t frames = 0;
  std::uint64_t bytes = 0;  ///< of the file so far; frames of the last second are not counted yet
  bool full = false;        ///< ended as it had as many bytes as it may have
  std::string scene{};      ///< the scene's name
  std::uint32_t vertices = 0;
  std::optional<std::pair<double, double>> times{};  ///< of the first and the newest frame [s]
  std::shared_ptr<const std::string> file{};         ///< once it is ready; else null
};

inline nlohmann::json facts_of(const RecordingFacts& facts) {
  constexpr const char* names[] = {"none", "recording", "ready"};
  nlohmann::json times = nullptr;
  if (facts.times) times = {facts.times->first, facts.times->second};
  return {{"state", names[static_cast<int>(facts.state)]},
          {"scene", facts.scene},
          {"rate", facts.rate},
          {"frames", facts.frames},
          {"bytes", facts.bytes},
          {"full", facts.full},
          {"times", std::move(times)}};
}

}  // namespace clothlab::session
