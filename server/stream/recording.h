// Writes a recording, a .clothlab file: a scene, what changed it, and the cloth at regular times. The format
// is in server/stream/README.md; the reader is web/src/player/recording.ts.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/stream/predictor.h"

namespace clothlab::stream {

/// The cloth at one moment of a recording.
struct RecordedFrame {
  double time = 0;  ///< [s]
  std::uint64_t step = 0;
  std::uint16_t flags = 0;               ///< flag_asleep, flag_diverged
  std::span<const glm::vec3> positions;  ///< [vertex_count] [m]
  nlohmann::json moving{
      nullptr};  ///< of moving colliders, as the notification `colliders` has it; null: none
};

/// Nothing else than this class's calls changes what it has been given; bytes come in the order of the file.
class Recording {
 public:
  /// `put` gets the bytes of the file. `scene` is the document, `rate` the frames a second [1/s] that were
  /// asked for.
  Recording(std::function<void(std::string_view)> put, const nlohmann::json& scene, double rate);

  /// The frames that follow are of this mesh.
  void set_mesh(const model::Model& model, const scene::Scene& scene);
  /// Adds a frame; it is written with its group, of about a second.
  void add(const RecordedFrame& frame);
  /// The scene changes before the next frame: {step, time, patch, by} or, as a whole, {step, time, document,
  /// by}.
  void change(const nlohmann::json& change);
  /// Ends the file. `ending` is a JSON object, to which the number of frames is added.
  void finish(nlohmann::json ending);

  std::uint64_t bytes() const { return bytes_; }  ///< written so far
  std::uint32_t frames() const { return frames_; }

 private:
  void chunk(const char (&kind)[5], std::string_view head, std::string_view content);
  void write_group();

  std::function<void(std::string_view)> put_;
  std::uint64_t bytes_ = 0;
  std::uint32_t frames_ = 0;
  std::size_t group_size_ = 1, most_in_group_ = 1;
  float finest_ = 0;  ///< of the mesh: positions are rounded to this [m], or to what 16 bits can count
  std::uint32_t revision_ = 0;
  Predictor predictor_;

  // The frames that wait.
  std::vector<double> times_;
  std::vector<std::uint64_t> steps_;
  std::vector<std::uint8_t> flags_;
  std::vector<glm::vec3> positions_;
  nlohmann::json moving_ = nlohmann::json::array();
};

/// A page that plays the recording in a browser without a server. Error: the page has not been built.
Result<std::string> player_page(std::string_view recording, const std::string& title);

}  // namespace clothlab::stream
