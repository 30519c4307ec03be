// Reads a recording that stream::Recording has written, or anybody else: all but the frames at once, the
// frames a group at a time, as often as somebody wants them. The page's reader is
// web/src/player/recording.ts.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/decode/frame.h"
#include "server/film/chunks.h"
#include "server/scene/scene.h"
#include "server/stream/predictor.h"

namespace clothlab::film {

/// The cloths' mesh in a stretch of a recording, and the meshes of its bodies.
struct RecordedMesh {
  decode::Topology topology;
  stream::Predictor predictor;
  /// By their colliders' numbers, before their transforms.
  std::map<std::uint32_t, std::shared_ptr<const scene::TriangleMesh>> bodies{};
};

/// Frames that are compressed together, with what they have in common.
struct Group {
  std::uint32_t first = 0, count = 0;  ///< the number of its first frame; its frames
  std::shared_ptr<const RecordedMesh> mesh;
  std::shared_ptr<const nlohmann::json> document;
  Chunk chunk;
};

/// The cloths at one moment, and the colliders that move.
struct Moment {
  double time = 0;  ///< simulated [s]
  std::uint64_t step = 0;
  nlohmann::json moving;             ///< a list, as the notification `colliders` has it
  std::vector<glm::vec3> positions;  ///< [vertex_count] [m]; empty if nobody asked for them
};

class Reader {
 public:
  /// `file` must stay where it is while this object is used.
  static Result<Reader> open(std::string_view file);

  const std::string& title() const { return title_; }  ///< the name of the scene that it begins with
  double rate() const { return rate_; }                ///< frames a second [1/s]
  std::uint32_t frames() const { return frames_; }
  const std::vector<Group>& groups() const { return groups_; }
  /// How it ended: null, or `reason` and `remedy`.
  const nlohmann::json& diverged() const { return diverged_; }

 private:
  Reader() = default;
  Status take(const Chunk& chunk);
  Status take_mesh(const Chunk& chunk, const std::string& content);
  Status take_body(const Chunk& chunk, const std::string& content);
  Status take_group(const Chunk& chunk);
  Status take_edit(const Chunk& chunk, const nlohmann::json& edit);

  std::string title_;
  double rate_ = 0;
  std::uint32_t frames_ = 0;
  std::vector<Group> groups_;
  nlohmann::json diverged_;
  bool done_ = false;
  std::shared_ptr<RecordedMesh> mesh_;  ///< of the frames that follow
  std::shared_ptr<const nlohmann::json> document_;
};

/// The bytes of a group's content before its deflate stream: how many frames, the origin, the quantum.
inline constexpr std::size_t group_head_bytes = 20;

/// A text of a JSON object, or `otherwise`.
std::string text_at(const nlohmann::json& object, const char* key, const std::string& otherwise);

/// The frames of a group.
Result<std::vector<Moment>> moments_of(const Group& group, bool with_positions);

/// When each frame of a film is shown [s]: from 0 on and rising with the simulated time, but where that
/// stands still or goes back, as in a session that was reset, a frame's time later.
class Clock {
 public:
  /// `rate`: frames a second [1/s].
  explicit Clock(double rate) : rate_(rate) {}
  /// Of the next frame, at this simulated time [s].
  double next(double simulated);

  static constexpr double rounding = 1e-9;  ///< of times that steps add up to [s]

 private:
  double rate_, before_ = 0, shown_ = -1;
};

}  // namespace clothlab::film
