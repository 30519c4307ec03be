#include "server/render/outline.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <variant>

#include "server/scene/placement.h"
#include "server/scene/solid.h"

namespace clothlab::render {

namespace {

std::vector<Ball> vertices_of(const scene::Body& body) {
  std::vector<Ball> vertices;
  for (const scene::dvec3& at : scene::placed(body.transform, body.mesh->vertices))
    vertices.push_back({glm::vec3(at), 0.0f});
  return vertices;
}

}  // namespace

std::vector<Ball> outline(const scene::Shape& shape) {
  if (const auto* body = std::get_if<scene::Body>(&shape)) return vertices_of(*body);
  if (!std::isfinite(scene::bounds(shape).radius)) return {};
  // Everything within the radius of a core, which is a cuboid, a line or a point.
  const scene::Solid solid = scene::solid(shape);
  const scene::dvec3 third = glm::cross(solid.direction, solid.second);
  std::vector<Ball> corners;
  for (int n = 0; n < 8; ++n) {
    const auto side = [n](int axis) { return (n >> axis) & 1 ? 1.0 : -1.0; };
    corners.push_back({glm::vec3(solid.point + side(0) * solid.extent.x * solid.direction +
                                 side(1) * solid.extent.y * solid.second + side(2) * solid.extent.z * third),
                       static_cast<float>(solid.radius)});
  }
  return corners;
}

}  // namespace clothlab::render
