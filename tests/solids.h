// A shape of each kind, and properties of it that do not use its law: for tests of solids.
#pragma once

#include <glm/geometric.hpp>
#include <vector>

#include "server/scene/solid.h"

namespace clothlab::test {

/// Depth of x below the surface [m]; less than 0 outside.
inline double depth(const scene::Sphere& sphere, const glm::dvec3& x) {
  return sphere.radius - glm::distance(x, sphere.center);
}
inline double depth(const scene::Plane& plane, const glm::dvec3& x) {
  return glm::dot(plane.point - x, plane.normal);
}
inline double depth(const scene::Shape& shape, const glm::dvec3& x) {
  return std::visit([&](const auto& of) { return depth(of, x); }, shape);
}

/// Shapes whose surface is within 1 m of the origin, with room for paths inside and outside.
inline const std::vector<scene::Shape> a_shape_of_each_kind{
    scene::Sphere{{0.1, -0.2, 0.05}, 0.5},
    scene::Plane{{0.2, -0.3, 0.1}, {0.0, 0.8, 0.6}},
};

}  // namespace clothlab::test
