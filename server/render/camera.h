// Where to look from, so that all of a box is well in the picture.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace clothlab::render {

/// An axis-aligned box that grows; empty until something finite is in it.
struct Box {
  glm::vec3 minimum{1e30f}, maximum{-1e30f};  ///< [m]

  bool empty() const { return minimum.x > maximum.x; }
  void add(const glm::vec3& point);
  void add(const glm::vec3& center, float radius);
  glm::vec3 center() const { return 0.5f * (minimum + maximum); }
  /// Half the diagonal [m].
  float radius() const;
};

struct Camera {
  glm::vec3 eye{0.0f};              ///< [m]
  glm::mat4 view_projection{1.0f};  ///< world to clip space
};

/// Looks at the box's centre from the front, a little from the right and above, just far enough for all of
/// the box to be in a picture of this aspect (width / height). An empty box is taken as 1 m about the origin.
Camera frame(const Box& box, float aspect);

/// Parallel projection along the light onto all of the box, for the shadow map.
glm::mat4 light_view_projection(const Box& box, const glm::vec3& to_light);

}  // namespace clothlab::render
