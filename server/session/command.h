// What is asked of a session's thread, and by whom.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "server/lab/measure/choice.h"
#include "server/scene/document.h"
#include "server/stream/frame.h"

namespace clothlab::session {

using nlohmann::json;
using stream::encoding_count;

/// Who asked, and the request's id (none: a notification, or the server itself). 0 is nobody.
struct Ticket {
  std::uint64_t asker = 0;
  std::optional<json> id;
  std::string method{};
  std::int64_t asked_us = 0;  ///< when it came
};

struct GetScene {};
struct LoadScene {
  std::string preset;  ///< or, where empty:
  json document;
};
struct PatchScene {
  json patch;
  std::optional<std::uint64_t> revision;  ///< the one the patch was made for
};
struct Play {};
struct Pause {};
struct Step {
  std::uint64_t steps = 1;
};
struct Reset {};
struct Speed {
  double factor = 1;
};
/// What viewers want: the highest rate of each encoding, and which are wanted at once, even while nothing
/// moves.
struct Demand {
  std::array<double, encoding_count> rate{};  ///< [1/s], 0: nobody
  std::array<bool, encoding_count> fresh{};
};
struct Watchers {
  int count = 0;
};
/// For a picture (width > 0) or a mesh for the HTTP API: answered by Captured; `Ticket::asker` is the HTTP
/// request.
struct Export {
  int width = 0, height = 0;  ///< [pixels]
};
/// For a job of the lab: answered by SceneReached, after what the commands before it have changed.
struct ReachScene {
  std::uint64_t job = 0;
};
/// Stands still if it plays, for a job of the lab to measure: answered by Held.
struct Hold {
  std::uint64_t job = 0;
};
/// Plays on, unless somebody has played, paused or stepped it since it was held.
struct Release {};
/// What the lab says to a scene with the method `auto`.
struct Chosen {
  std::shared_ptr<const scene::Document> measured;
  Result<lab::Choice> choice;
};
struct Command {
  Ticket ticket;
  std::variant<GetScene, LoadScene, PatchScene, Play, Pause, Step, Reset, Speed, Demand, Watchers, Export,
               ReachScene, Hold, Release, Chosen>
      what;
};

}  // namespace clothlab::session
