// A solid of each kind, and properties of it that do not use its law: for tests of solids.
#pragma once

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <vector>

#include "server/scene/solid.h"

namespace clothlab::test {

/// A turn about the vector `turn` by its length [rad].
inline glm::dmat3 turned_by(const glm::dvec3& turn) {
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::length(turn), glm::normalize(turn)));
}

/// Depth of x below the surface [m]; less than 0 outside.
inline double depth(const scene::Sphere& sphere, const glm::dvec3& x) {
  return sphere.radius - glm::distance(x, sphere.center);
}
inline double depth(const scene::Plane& plane, const glm::dvec3& x) {
  return glm::dot(plane.point - x, plane.normal);
}
inline double depth(const scene::Capsule& capsule, const glm::dvec3& x) {
  const glm::dvec3 axis = capsule.b - capsule.a;
  const double share = glm::clamp(glm::dot(x - capsule.a, axis) / glm::dot(axis, axis), 0.0, 1.0);
  return capsule.radius - glm::distance(x, capsule.a + share * axis);
}
inline double depth(const scene::Box& box, const glm::dvec3& x) {
  const glm::dvec3 beyond = glm::abs(glm::transpose(box.axes) * (x - box.center)) - box.half;
  const double farthest = std::max({beyond.x, beyond.y, beyond.z});
  return farthest < 0.0 ? -farthest : -glm::length(glm::max(beyond, glm::dvec3(0.0)));
}
/// A body of triangles is no solid: nothing here is deep in one.
inline double depth(const scene::Body&, const glm::dvec3&) {
  return -std::numeric_limits<double>::infinity();
}
inline double depth(const scene::Shape& shape, const glm::dvec3& x) {
  return std::visit([&](const auto& of) { return depth(of, x); }, shape);
}

/// Shapes whose surface is within 1 m of the origin, with room for paths inside and outside.
inline const std::vector<scene::Shape> a_shape_of_each_kind{
    scene::Sphere{{0.1, -0.2, 0.05}, 0.5},
    scene::Plane{{0.2, -0.3, 0.1}, {0.0, 0.8, 0.6}},
    scene::Capsule{{-0.3, -0.2, 0.2}, {0.4, 0.1, -0.1}, 0.3},
    scene::Box{{0.1, -0.1, 0.05}, {0.5, 0.2, 0.35}, turned_by({0.3, -0.5, 0.7})},
};

}  // namespace clothlab::test
