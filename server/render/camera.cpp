#include "server/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

namespace clothlab::render {

namespace {

const glm::vec3 view_direction = glm::normalize(glm::vec3(0.62f, 0.3f, 1.0f));  // from the centre to the eye
const glm::vec3 up{0.0f, 1.0f, 0.0f};
constexpr float vertical_field = 32.0f;   // [degrees]
constexpr float margin = 1.08f;           // factor: space around the box
constexpr float smallest_radius = 1e-4f;  // [m]; a single point becomes a box of this radius

glm::vec3 corner(const Box& box, int index) {
  return {index & 1 ? box.maximum.x : box.minimum.x, index & 2 ? box.maximum.y : box.minimum.y,
          index & 4 ? box.maximum.z : box.minimum.z};
}

/// The box to look at: `box`, enlarged if it is empty or a single point.
Box visible(const Box& box) {
  Box result = box;
  if (box.empty()) result.add(glm::vec3(0.0f), 1.0f);
  if (result.radius() < smallest_radius) result.add(result.center(), smallest_radius);
  return result;
}

}  // namespace

void Box::add(const glm::vec3& point) {
  if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) return;
  minimum = glm::min(minimum, point);
  maximum = glm::max(maximum, point);
}

void Box::add(const glm::vec3& center, float radius) {
  add(center - glm::vec3(radius));
  add(center + glm::vec3(radius));
}

float Box::radius() const {
  return 0.5f * glm::distance(minimum, maximum);
}

Camera frame(const Box& seen, float aspect) {
  const Box box = visible(seen);
  const glm::vec3 center = box.center();
  const glm::vec3 right = glm::normalize(glm::cross(up, view_direction));
  const glm::vec3 above = glm::cross(view_direction, right);
  const float tan_y = std::tan(glm::radians(0.5f * vertical_field));
  const float tan_x = tan_y * aspect;

  // A corner at (x, y, z) in the eye's axes is inside the picture if distance - z is at least |x| / tan_x and
  // at least |y| / tan_y.
  float distance = 0.0f;
  for (int index = 0; index < 8; ++index) {
    const glm::vec3 offset = margin * (corner(box, index) - center);
    const float side =
        std::max(std::abs(glm::dot(offset, right)) / tan_x, std::abs(glm::dot(offset, above)) / tan_y);
    distance = std::max(distance, glm::dot(offset, view_direction) + side);
  }
  Camera camera;
  camera.eye = center + distance * view_direction;
  const float nearest = 0.02f * distance, farthest = distance + 40.0f * box.radius();
  camera.view_projection = glm::perspective(glm::radians(vertical_field), aspect, nearest, farthest) *
                           glm::lookAt(camera.eye, center, up);
  return camera;
}

glm::mat4 light_view_projection(const Box& seen, const glm::vec3& to_light) {
  const Box box = visible(seen);
  const float radius = 1.02f * box.radius();
  const glm::mat4 view =
      glm::lookAt(box.center() + 2.0f * radius * to_light, box.center(), glm::vec3(0, 0, 1));
  return glm::ortho(-radius, radius, -radius, radius, 0.5f * radius, 4.0f * radius) * view;
}

}  // namespace clothlab::render
