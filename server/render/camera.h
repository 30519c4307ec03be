// Chooses a camera that fills a picture with what it is of.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

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

/// A part of what a picture is of; a vertex has the radius 0.
struct Ball {
  glm::vec3 center{0.0f};  ///< [m], finite
  float radius = 0;        ///< [m], finite
};

/// What is said of a camera. What is left out is chosen so that the subject fills the picture.
struct View {
  std::optional<glm::vec3> from{};  ///< the eye [m]; none: in front, a little to the right and above
  std::optional<glm::vec3> to{};    ///< what is in the picture's middle [m]; none: the subject
  std::optional<float> angle{};     ///< between the picture's lower and upper edge [degrees], in (0, 180)
};

/// A camera whose picture of this aspect (width / height) has all of the subject, in its middle and as large
/// as a small margin allows. `all`: everything that is drawn. Without any ball the subject is a ball of 1 m
/// around the origin.
Camera frame(std::span<const Ball> subject, const Box& all, const View& view, float aspect);

/// The parallel projection along the light that has all of the box in the shadow map. `to_light`: length 1.
glm::mat4 light_view_projection(const Box& box, const glm::vec3& to_light);

}  // namespace clothlab::render
