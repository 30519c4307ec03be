// The commands to a session's thread, each with a ticket that says who sent it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "server/lab/measure/choice.h"
#include "server/scene/document.h"
#include "server/session/history.h"
#include "server/stream/frame.h"

namespace clothlab::session {

using nlohmann::json;
using stream::form_count;

/// Says who sent a command and which answer it needs.
struct Ticket {
  std::uint64_t asker = 0;  ///< the client's number; 0: the server itself
  std::optional<json> id;   ///< the request's id; none: a notification, or a command of the server
  std::string method{};
  std::int64_t asked_us = 0;  ///< when the request came, on the clock of now_us [us]
  bool at_length = false;  ///< its answer may be long, and the client is asked for no other before it has it
};

struct GetScene {};
struct LoadScene {
  std::string preset;  ///< the preset's name; empty: `document` is loaded
  json document;
};
/// A mesh's file, for scenes to name.
struct UploadMesh {
  std::string name;
  std::string bytes;
  bool in_base64 = false;           ///< the bytes are in base64 still (RFC 4648, padded)
  std::shared_ptr<void> in_hand{};  ///< freed once the bytes are read: the client may send others then
};
struct PatchScene {
  json patch;
  std::optional<std::uint64_t> revision;  ///< the scene revision that the patch was made for; none: any
  std::string name{};                     ///< what the history calls it; empty: by what it changes
  bool keep_stable = false;               ///< change the solver, too, if the cloth would not hold with it
};
/// Undoes or redoes a change of the scene.
struct TravelHistory {
  Direction direction = Direction::undo;
  std::optional<std::uint64_t> revision;  ///< as of PatchScene
};
struct Play {};
struct Pause {};
struct Step {
  std::uint64_t steps = 1;
};
struct Reset {};
/// Records the session from now on.
struct RecordStart {
  double rate = 30;  ///< frames a second at most [1/s]
};
struct RecordStop {};
/// Asks for the springs of the scene, or its finite elements, from this one on.
struct InspectSprings {
  std::size_t first = 0;
};
struct InspectElements {
  std::size_t first = 0;
};
/// Asks which vertices became of those that the document counts of a cloth, from this one on.
struct InspectVertices {
  std::uint32_t cloth = 0;
  std::size_t first = 0;
};
/// Asks for so many of the pairs that contact keeps apart, the nearest ones.
struct InspectContacts {
  std::size_t most = 0;
};
struct Speed {
  double factor = 1;
};
/// The frames that viewers want, for each form, at its index.
struct Demand {
  std::array<double, form_count> rate{};  ///< the highest rate wanted [1/s]; 0: no viewer wants frames
  std::array<bool, form_count> fresh{};   ///< true: a frame is wanted at once, even if nothing moves
};
struct Watchers {
  int count = 0;
};
/// Asks for the present state for the HTTP API, which makes a file from it. Answered by Captured.
/// `Ticket::asker` is the HTTP request.
struct Export {
  enum class Kind { obj, glb, picture } kind = Kind::obj;
  int width = 0, height = 0;  ///< of a picture [pixels]
  /// Of a recording, in place of all that: the ending of the file to make, ".html" or a film's
  /// (film/formats.h).
  std::string recording{};
};
/// Asks which steps the session can go on from.
struct GetTimeline {};
/// Goes back to this step, and pauses there; none: to where the last such request left the run, with what had
/// come until then.
struct ResumeAt {
  std::optional<std::uint64_t> step;
};
/// Tells a job of the lab when the commands before this one are done. Answered by SceneReached.
struct ReachScene {
  std::uint64_t job = 0;
};
/// Pauses a playing session, so that a job of the lab can measure. Answered by Held.
struct Hold {
  std::uint64_t job = 0;
};
/// Ends a Hold: the session plays on, unless a client has played, paused or stepped it in the meantime.
struct Release {};
/// The lab's choice, or its error, for a scene with the method `auto`.
struct Chosen {
  std::shared_ptr<const scene::Document> measured;
  Result<lab::Choice> choice;
};
/// Puts one of the client's hands on a vertex of a cloth.
struct GrabStart {
  int hand = 0;
  std::uint32_t cloth = 0, vertex = 0;
  scene::dvec3 target{0.0};  ///< where the hand would have the vertex [m]
};
struct GrabMove {
  int hand = 0;
  scene::dvec3 target{0.0};  ///< [m]
};
struct GrabEnd {
  std::optional<int> hand;  ///< none: all hands of the client
};
struct Command {
  Ticket ticket;
  std::variant<GetScene, LoadScene, UploadMesh, PatchScene, TravelHistory, Play, Pause, Step, Reset, Speed,
               Demand, Watchers, Export, ReachScene, Hold, Release, Chosen, GrabStart, GrabMove, GrabEnd,
               GetTimeline, ResumeAt, RecordStart, RecordStop, InspectSprings, InspectElements,
               InspectVertices, InspectContacts>
      what;
};

}  // namespace clothlab::session
