#include "server/sim/colliders.h"

#include <algorithm>
#include <glm/vec4.hpp>

#include "server/model/motion.h"

namespace clothlab::sim {

double contact_margin(const scene::Scene& scene, const model::Model& model) {
  if (scene.self_collision) return 0.5 * scene.self_collision->thickness;
  double edge = 0.0;
  for (const model::ClothRange& cloth : model.cloths) edge = std::max(edge, cloth.mean_edge_length);
  return 0.01 * edge;
}

void set_colliders(const gl::Program& program, const scene::Scene& scene, const MotionTable& motions,
                   double margin) {
  std::vector<glm::vec4> spheres, points;
  std::vector<glm::vec3> sphere_surfaces, normals, plane_surfaces;
  for (const scene::Collider& collider : scene.colliders) {
    const glm::vec3 surface(collider.friction, collider.restitution, motions.index(collider.motion));
    if (const auto* sphere = std::get_if<scene::Sphere>(&collider.shape)) {
      spheres.emplace_back(glm::vec3(sphere->center), static_cast<float>(sphere->radius + margin));
      sphere_surfaces.push_back(surface);
    } else if (const auto* plane = std::get_if<scene::Plane>(&collider.shape)) {
      points.emplace_back(glm::vec3(plane->point), static_cast<float>(margin));
      normals.emplace_back(plane->normal);
      plane_surfaces.push_back(surface);
    }
  }
  const auto set3 = [&](const char* name, const std::vector<glm::vec3>& values) {
    if (!values.empty())
      glProgramUniform3fv(program.id(), program.uniform(name), static_cast<GLsizei>(values.size()),
                          &values[0].x);
  };
  const auto set4 = [&](const char* name, const std::vector<glm::vec4>& values) {
    if (!values.empty())
      glProgramUniform4fv(program.id(), program.uniform(name), static_cast<GLsizei>(values.size()),
                          &values[0].x);
  };
  set4("sphere", spheres);
  set3("sphere_surface", sphere_surfaces);
  set4("plane_point", points);
  set3("plane_normal", normals);
  set3("plane_surface", plane_surfaces);
}

std::vector<scene::Collider> colliders_at(const scene::Scene& scene, double time) {
  std::vector<scene::Collider> colliders = scene.colliders;
  for (scene::Collider& collider : colliders) {
    const model::Pose pose = model::pose(collider.motion, time);
    if (auto* sphere = std::get_if<scene::Sphere>(&collider.shape))
      sphere->center = pose.place(sphere->center);
    if (auto* plane = std::get_if<scene::Plane>(&collider.shape)) {
      plane->point = pose.place(plane->point);
      plane->normal = pose.rotation * plane->normal;
    }
  }
  return colliders;
}

}  // namespace clothlab::sim
