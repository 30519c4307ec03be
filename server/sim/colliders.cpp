#include "server/sim/colliders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec4.hpp>
#include <variant>

#include "server/model/bodies.h"
#include "server/model/motion.h"
#include "server/model/thickness.h"
#include "server/scene/solid.h"
#include "shaders/elements/elements.h"

namespace clothlab::sim {

double contact_margin(const scene::Scene& scene, const model::Model& model) {
  return scene.self_collision ? 0.5 * scene.self_collision->thickness : 0.01 * model::coarsest_edge(model);
}

double contact_margin(const scene::Scene& scene, const model::Model& model, const scene::Collider& collider) {
  const double margin = contact_margin(scene, model);
  const bool may_cut = scene.collides(scene::ContactKind::surface) &&
                       std::holds_alternative<scene::Box>(collider.shape) &&
                       !model::has_edges(scene, collider);
  return may_cut ? std::max(margin, model::coarsest_edge(model) / std::sqrt(8.0)) : margin;
}

void set_colliders(const gl::Program& program, const scene::Scene& scene, const model::Model& model,
                   const MotionTable& motions) {
  std::vector<glm::vec4> rows;  // those of each collider as shaders/collide/colliders.glsl has them
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind)
    for (const scene::Collider& collider : scene.colliders) {
      if (collider.shape.index() != kind) continue;
      const scene::Solid solid = scene::solid(collider.shape);
      rows.emplace_back(glm::vec3(solid.point),
                        static_cast<float>(solid.radius + contact_margin(scene, model, collider)));
      rows.emplace_back(glm::vec3(solid.direction), static_cast<float>(solid.extent.x));
      rows.emplace_back(collider.friction, collider.restitution, motions.index(collider.motion),
                        solid.extent.y);
      if (elements::solid_has_axes(solid.kind))
        rows.emplace_back(glm::vec3(solid.second), static_cast<float>(solid.extent.z));
    }
  if (rows.empty()) return;
  glProgramUniform4fv(program.id(), program.location("solids"), static_cast<GLsizei>(rows.size()),
                      &rows[0].x);
}

std::vector<scene::Collider> colliders_at(const scene::Scene& scene, double time) {
  std::vector<scene::Collider> colliders = scene.colliders;
  for (scene::Collider& collider : colliders) {
    const model::Pose pose = model::pose(collider.motion, time);
    collider.shape = scene::moved_shape(collider.shape, pose.rotation, pose.translation);
  }
  return colliders;
}

}  // namespace clothlab::sim
