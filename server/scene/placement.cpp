#include "server/scene/placement.h"

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

namespace clothlab::scene {

namespace {

/// Rotates points about a coordinate axis (0: x, 1: y, 2: z).
struct Turn {
  int axis = 0;
  double cosine = 1, sine = 0;
  Turn(int about, double degrees)
      : axis(about), cosine(std::cos(glm::radians(degrees))), sine(std::sin(glm::radians(degrees))) {}

  dvec3 operator()(const dvec3& point) const {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    dvec3 turned = point;
    turned[a] = cosine * point[a] - sine * point[b];
    turned[b] = sine * point[a] + cosine * point[b];
    return turned;
  }
};

}  // namespace

glm::dmat3 turn(const dvec3& degrees) {
  glm::dmat4 all(1.0);
  for (int axis = 2; axis >= 0; --axis) {
    dvec3 about(0.0);
    about[axis] = 1.0;
    all = glm::rotate(all, glm::radians(degrees[axis]), about);
  }
  return glm::dmat3(all);
}

dvec3 angles(const glm::dmat3& axes) {
  const double level = std::hypot(axes[0][0], axes[0][1]);
  const bool upright = level < 1e-12;
  return glm::degrees(
      dvec3(upright ? std::atan2(-axes[2][1], axes[1][1]) : std::atan2(axes[1][2], axes[2][2]),
            std::atan2(-axes[0][2], level), upright ? 0.0 : std::atan2(axes[0][1], axes[0][0])));
}

std::vector<dvec3> placed(const Transform& transform, std::vector<dvec3> points) {
  const std::array turns{Turn(0, transform.rotate[0]), Turn(1, transform.rotate[1]),
                         Turn(2, transform.rotate[2])};
  for (dvec3& point : points) {
    point *= transform.scale;
    for (const Turn& turn : turns) point = turn(point);
    point += transform.translate;
  }
  return points;
}

Transform moved(const Transform& home, const glm::dmat3& rotation, const dvec3& translation) {
  if (rotation == glm::dmat3(1.0)) return {home.translate + translation, home.rotate, home.scale};
  return {rotation * home.translate + translation, angles(rotation * turn(home.rotate)), home.scale};
}

}  // namespace clothlab::scene
