// Chooses a camera that has all of a box in its picture.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace clothlab::render {

/// An axis-aligned box that grows to contain what is added; empty until a finite point is added.
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
/// the box to be in a picture of this aspect (width / height). An empty box counts as a cube around the
/// origin with sides of 2 m.
Camera frame(const Box& box, float aspect);

/// The parallel projection along the light that has all of the box in the shadow map. `to_light`: length 1.
glm::mat4 light_view_projection(const Box& box, const glm::vec3& to_light);

}  // namespace clothlab::render
