// The bodies of a film, and how they move. A body that moves and one whose place was changed by hand are the
// same here: each frame has a pose.
#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/film/reader.h"
#include "server/scene/scene.h"

namespace clothlab::film {

/// A shape around its origin, before its pose.
struct Form {
  enum class Kind { ball, box, capsule, square, mesh } kind = Kind::ball;  ///< a plane is a square
  double radius = 1;                                                       ///< of a capsule [m]; a ball has 1
  double half_length = 1;  ///< of a capsule's line along x, of a square's edge in x and z [m]; a box has 1
  std::shared_ptr<const scene::TriangleMesh> mesh{};
};

/// Scaled, then turned, then moved.
struct Pose {
  glm::dvec3 place{0.0};                ///< [m]
  glm::dquat turn{1.0, 0.0, 0.0, 0.0};  ///< each nearer to that of the frame before than its opposite is
  glm::dvec3 scale{1.0};
  bool operator==(const Pose&) const = default;
};

struct Body {
  std::string name;
  Form form;
  std::vector<std::optional<Pose>> poses{};  ///< [frame]; none: it is not there
  /// True if a pose differs from the first one.
  bool moves() const;
  bool always_there() const;
};

/// The colliders of a frame. Error: what the recording says of them is no collider.
Result<std::vector<scene::Collider>> colliders_of(const Group& group, const nlohmann::json& moving);

/// Follows the colliders from frame to frame.
class BodyTracks {
 public:
  /// Planes are shown as squares of `half_length` [m] with their middle next to `middle`.
  BodyTracks(const glm::dvec3& middle, double half_length) : middle_(middle), half_length_(half_length) {}
  /// The colliders of the next frame. A collider that becomes another shape is another body from then on.
  void add(const std::vector<scene::Collider>& colliders);
  std::vector<Body> take();

 private:
  struct Track {
    Body body;
    std::size_t collider = 0;
    glm::dvec3 aside{0.0};  ///< of a plane: from its point to the middle of its square, as it lies at first
  };
  Track& track_of(std::size_t collider, const scene::Collider& now);
  Pose pose(Track& track, const scene::Shape& shape) const;
  glm::dquat turned(const Track& track, const glm::dvec3& axis, const glm::dvec3& home) const;

  glm::dvec3 middle_;
  double half_length_;
  std::size_t frames_ = 0;
  std::vector<Track> tracks_;
};

}  // namespace clothlab::film
