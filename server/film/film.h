// A film: what writers of files for other programs need of a recording. One mesh, its frames as often as a
// writer wants to go through them, and the bodies with their motion. Only one group of frames is in memory at
// a time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/film/bodies.h"
#include "server/film/reader.h"

namespace clothlab::film {

struct Cloth {
  std::string name;
  std::array<double, 3> colour{};  ///< in linear light
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::vector<std::array<std::uint32_t, 3>> triangles{};  ///< vertices count within the cloth
};

/// How much of a recording becomes a film.
struct Choice {
  std::optional<double> time;  ///< up to so long after the first frame [s]; none: all
  std::optional<double> rate;  ///< at most about so many frames a second [1/s], at least one; none: all
};

class Film {
 public:
  /// The bytes of `recording` must stay where they are while the film is used. Error: it is damaged, has no
  /// frames, or its mesh changes.
  static Result<Film> of(std::string_view recording, const Choice& choice = {});

  std::string title;          ///< the scene's name
  double rate = 0;            ///< frames a second [1/s]
  double from = 0, to = 0;    ///< simulated times of the first and the last frame [s]
  std::vector<double> times;  ///< when each frame is shown [s], from 0 on and rising; see Clock
  std::vector<Cloth> cloths;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< of all cloths
  std::vector<glm::vec2> texture_coordinates;           ///< [vertex_count]
  std::vector<Body> bodies;
  glm::vec3 low{0.0f}, high{0.0f};  ///< the box of the first frame [m]

  std::uint32_t frames() const { return static_cast<std::uint32_t>(times.size()); }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(texture_coordinates.size()); }

  /// Calls `take` with each frame's number and its positions [vertex_count] [m]. An error of it ends that.
  using Take = std::function<Status(std::uint32_t, std::span<const glm::vec3>)>;
  Status each_frame(const Take& take) const;

 private:
  Film() = default;
  Status take_looks();
  Status take_motion(std::optional<double> time);
  /// Calls `take` with each chosen frame and its group.
  Status each_moment(bool with_positions,
                     const std::function<Status(std::uint32_t, const Group&, Moment&)>& take) const;

  std::vector<Group> groups_;
  std::uint32_t every_ = 1;  ///< of the recording's frames each so many is one of the film
  std::uint32_t end_ = 0;    ///< the first frame of the recording that is not in the film
};

}  // namespace clothlab::film
