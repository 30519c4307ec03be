#include "server/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <vector>

namespace clothlab::render {

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

namespace {

const glm::vec3 view_direction = glm::normalize(glm::vec3(0.62f, 0.3f, 1.0f));  // from the centre to the eye
const glm::vec3 up{0.0f, 1.0f, 0.0f};
constexpr float vertical_field = 32.0f;   // [degrees]
constexpr float widest_field = 150.0f;    // [degrees] that is chosen
constexpr float margin = 1.08f;           // factor: space around the subject
constexpr float smallest_radius = 1e-4f;  // [m]; a single point becomes a ball of this radius
constexpr float steepest = 1e6f;          // slope of what is beside the eye

/// The box to look at: `box`, enlarged if it is empty or a single point.
Box visible(const Box& box) {
  Box result = box;
  if (box.empty()) result.add(glm::vec3(0.0f), 1.0f);
  if (result.radius() < smallest_radius) result.add(result.center(), smallest_radius);
  return result;
}

/// The balls to look at: a ball in the place of none and of a single point.
std::vector<Ball> visible(std::span<const Ball> balls) {
  Box box;
  for (const Ball& ball : balls) box.add(ball.center, ball.radius);
  if (box.empty()) return {{glm::vec3(0.0f), 1.0f}};
  if (box.radius() < smallest_radius) return {{box.center(), smallest_radius}};
  return {balls.begin(), balls.end()};
}

/// The axes of a camera: `back` is from what it looks at to the eye.
struct Axes {
  glm::vec3 right, above, back;

  explicit Axes(const glm::vec3& to_eye) : back(glm::normalize(to_eye)) {
    const bool upright = std::abs(glm::dot(back, up)) < 0.9999f;
    right = glm::normalize(glm::cross(upright ? up : glm::vec3(0, 0, -1), back));
    above = glm::cross(back, right);
  }

  /// Balls as they are from `origin` along these axes.
  std::vector<Ball> of(std::span<const Ball> balls, const glm::vec3& origin) const {
    std::vector<Ball> turned(balls.begin(), balls.end());
    for (Ball& ball : turned) {
      const glm::vec3 at = ball.center - origin;
      ball.center = {glm::dot(at, right), glm::dot(at, above), glm::dot(at, back)};
    }
    return turned;
  }
};

/// How far the line from the eye that touches a ball on one side goes to that side for each metre ahead: the
/// line in the direction (s, 1) passes (across, ahead) at the distance `radius`.
float slope(float across, float ahead, float radius) {
  if (ahead <= radius) return steepest;
  const float room = (ahead - radius) * (ahead + radius);
  return std::min((across * ahead + radius * std::sqrt(across * across + room)) / room, steepest);
}

/// The slopes of the lines from an eye to both edges of what it sees, along an axis (0 across, 1 up).
struct Edges {
  float least = steepest, most = -steepest;

  Edges(std::span<const Ball> turned, int axis, float eye, float away) {
    for (const Ball& ball : turned) {
      const float across = ball.center[axis] - eye, ahead = away - ball.center.z;
      most = std::max(most, slope(across, ahead, ball.radius));
      least = std::min(least, -slope(-across, ahead, ball.radius));
    }
  }
  float farther() const { return std::max(most, -least); }
  /// The slope of the line in the middle between both.
  float middle() const { return std::tan(0.5f * (std::atan(least) + std::atan(most))); }
};

/// How far away, along `back`, an eye sees all balls within slopes of `half`, which a ball at (x, z) is while
/// |x - eye x| + radius sqrt(1 + half^2) <= half (eye z - z). `centred`: the eye may move along the axis,
/// else it is at its 0.
float distance_for(std::span<const Ball> turned, int axis, float half, bool centred) {
  float ahead = -1e30f, behind = -1e30f;
  for (const Ball& ball : turned) {
    const float more = half * ball.center.z + ball.radius * std::sqrt(1 + half * half);
    ahead = std::max(ahead, ball.center[axis] + more);
    behind = std::max(behind, more - ball.center[axis]);
  }
  return (centred ? 0.5f * (ahead + behind) : std::max(ahead, behind)) / half;
}

/// The place along an axis of an eye at the depth `away` that sees as far to one side as to the other.
float centred(std::span<const Ball> turned, int axis, float away) {
  float least = 1e30f, most = -1e30f;
  for (const Ball& ball : turned) {
    least = std::min(least, ball.center[axis] - ball.radius);
    most = std::max(most, ball.center[axis] + ball.radius);
  }
  constexpr int halvings = 24;  // as many as a float has digits
  for (int i = 0; i < halvings; ++i) {
    const float middle = 0.5f * (least + most);
    const Edges edges(turned, axis, middle, away);
    (edges.most > -edges.least ? least : most) = middle;
  }
  return 0.5f * (least + most);
}

/// The axes of an eye that sees as far to one side as to the other, upwards as downwards.
Axes aimed(std::span<const Ball> subject, const glm::vec3& eye, const glm::vec3& first) {
  Axes axes(eye - first);
  constexpr int rounds = 8;  // one would do if turning up and down did not change what is seen to the sides
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Ball> turned = axes.of(subject, eye);
    axes = Axes(axes.back - Edges(turned, 0, 0, 0).middle() * axes.right -
                Edges(turned, 1, 0, 0).middle() * axes.above);
  }
  return axes;
}

}  // namespace

Camera frame(std::span<const Ball> seen, const Box& all, const View& view, float aspect) {
  const std::vector<Ball> subject = visible(seen);
  Box box;
  for (const Ball& ball : subject) box.add(ball.center, ball.radius);
  const glm::vec3 middle = view.to.value_or(box.center());
  float tangent = std::tan(glm::radians(0.5f * view.angle.value_or(vertical_field)));  // of half the picture

  Axes axes(view_direction);
  glm::vec3 eye;
  if (view.from) {
    eye = *view.from;
    if (glm::distance(eye, middle) > smallest_radius)
      axes = view.to ? Axes(eye - middle) : aimed(subject, eye, middle);
    const std::vector<Ball> turned = axes.of(subject, eye);
    if (!view.angle)
      tangent = std::min(
          margin * std::max(Edges(turned, 1, 0, 0).farther(), Edges(turned, 0, 0, 0).farther() / aspect),
          std::tan(glm::radians(0.5f * widest_field)));
  } else {
    const std::vector<Ball> turned = axes.of(subject, middle);
    const float high = tangent / margin, wide = high * aspect;
    const float away =
        std::max(distance_for(turned, 0, wide, !view.to), distance_for(turned, 1, high, !view.to));
    eye = middle + away * axes.back;
    if (!view.to) eye += centred(turned, 0, away) * axes.right + centred(turned, 1, away) * axes.above;
  }
  const float distance = std::max(glm::dot(eye - box.center(), axes.back), smallest_radius);
  const Box drawn = visible(all);
  const float nearest =
      (view.from ? 0.002f : 0.02f) * distance;  // an eye may be told to stand near the cloth
  const float farthest = glm::distance(eye, drawn.center()) + 40.0f * std::max(drawn.radius(), box.radius());
  Camera camera;
  camera.eye = eye;
  camera.view_projection = glm::perspective(2.0f * std::atan(tangent), aspect, nearest, farthest) *
                           glm::lookAt(eye, eye - axes.back, axes.above);
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
