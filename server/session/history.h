// The changes of a session's scene, in a line, so that anybody can undo and redo them: each with a name, who
// made it, and the way back and forth. Bounded in number and bytes. Plain data: it changes no scene.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/session/mesh_shelf.h"

namespace clothlab::session {

using nlohmann::json;

inline constexpr std::size_t max_changes = 100;  ///< that can be undone and redone, of a session
/// Of all of them together, unless the server has little memory: the texts of their patches or documents, and
/// the meshes that uploads replaced.
inline constexpr std::size_t max_change_bytes = 16 * 1024 * 1024;

enum class Direction { undo, redo };

class History {
 public:
  using Clock = std::chrono::steady_clock;

  /// `most`: bytes of all changes together.
  explicit History(std::size_t most = max_change_bytes) : most_(most) {}

  /// A mesh that an upload has put in the place of another, which the scene named (null: of a file).
  struct MeshChange {
    std::string name;
    MeshShelf::SharedItem before, after;
  };
  struct Change {
    std::string name;         ///< for people
    std::uint64_t by = 0;     ///< the client's number
    std::string back, forth;  ///< JSON: an array is an RFC 6902 patch, an object a whole document
    std::optional<MeshChange> mesh{};
    bool loaded = false;       ///< a scene was loaded: the cloth begins anew, either way
    std::string places{};      ///< where it changed the scene; empty: nowhere
    bool values_only = false;  ///< it has only replaced values, as a slider does
    Clock::time_point at{};    ///< when its last part came
    bool continues = false;    ///< it takes the place of the last change, of which it is a further part
    std::size_t bytes() const;
  };

  /// The change from one document to another. An empty name: it is made from what differs. Values that one
  /// client changes at the same places within `one_change` of each other are one change.
  Change prepare(const json& before, const json& after, std::string name, std::uint64_t by,
                 Clock::time_point now) const;
  /// Adds what `prepare` made, unless nothing differs. Drops what could be redone; forgets the oldest changes
  /// beyond the bounds.
  void add(Change change);

  /// The change that is undone or redone next; null: there is none.
  const Change* next(Direction direction) const;
  /// The document to which `next` leads from the present one. There must be one.
  Result<json> target(Direction direction, const json& present) const;
  /// `next` was undone or redone by a client.
  void moved(Direction direction, std::uint64_t by);

  /// The content of the notification scene.history.
  json told() const;

  static constexpr std::chrono::milliseconds one_change{1000};

 private:
  struct Last {  ///< what was done last
    const char* what = "";
    std::string name;
    std::uint64_t by = 0;
  };
  bool further_part(const Change& change) const;
  void forget_oldest();

  std::size_t most_;
  std::deque<Change> changes_;  ///< the oldest first
  std::size_t done_ = 0;        ///< of them: the others were undone
  bool open_ = false;           ///< the last change may get further parts
  std::optional<Last> last_;
};

}  // namespace clothlab::session
