#include "server/sim/colliders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <variant>

#include "server/model/bodies.h"
#include "server/model/motion.h"
#include "server/scene/solid.h"
#include "shaders/elements/elements.h"

namespace clothlab::sim {

namespace {

/// True if an edge between two vertices, each as far from the collider as its thickness says, may cut it.
bool may_cut(const scene::Scene& scene, const scene::Collider& collider) {
  return scene.collides(scene::ContactKind::surface) && std::holds_alternative<scene::Box>(collider.shape) &&
         !model::has_edges(scene, collider);
}

template <class Margin>
double least(const model::Model& model, Margin margin) {
  double found = margin(0);
  for (std::uint32_t cloth = 1; cloth < model.cloths.size(); ++cloth) found = std::min(found, margin(cloth));
  return found;
}

/// For each cloth its first vertex and how much farther it is kept from the solids than the least of all:
/// from all of them, or from those that would cut its edges (Plan::cloths_apart).
std::vector<glm::vec2> cloths_apart(const scene::Scene& scene, const model::Model& model) {
  const auto cutting = std::find_if(scene.colliders.begin(), scene.colliders.end(),
                                    [&](const scene::Collider& solid) { return may_cut(scene, solid); });
  const bool any = cutting != scene.colliders.end();
  std::vector<glm::vec2> rows;
  for (std::uint32_t cloth = 0; cloth < model.cloths.size(); ++cloth) {
    const double farther =
        any ? contact_margin(scene, model, cloth, *cutting) - least_contact_margin(scene, model, *cutting)
            : contact_margin(scene, model, cloth) - least_contact_margin(scene, model);
    rows.emplace_back(model.cloths[cloth].first_vertex, farther);
  }
  return rows;
}

}  // namespace

double contact_margin(const scene::Scene& scene, const model::Model& model, std::uint32_t cloth) {
  return scene.self_collision ? 0.5 * scene.self_collision->thickness
                              : 0.01 * model.cloths[cloth].mean_edge_length;
}

double contact_margin(const scene::Scene& scene, const model::Model& model, std::uint32_t cloth,
                      const scene::Collider& collider) {
  const double margin = contact_margin(scene, model, cloth);
  return may_cut(scene, collider) ? std::max(margin, model.cloths[cloth].mean_edge_length / std::sqrt(8.0))
                                  : margin;
}

std::vector<double> contact_margins(const scene::Scene& scene, const model::Model& model) {
  std::vector<double> margins;
  for (std::uint32_t cloth = 0; cloth < model.cloths.size(); ++cloth)
    margins.push_back(contact_margin(scene, model, cloth));
  return margins;
}

double least_contact_margin(const scene::Scene& scene, const model::Model& model) {
  return least(model, [&](std::uint32_t cloth) { return contact_margin(scene, model, cloth); });
}

double least_contact_margin(const scene::Scene& scene, const model::Model& model,
                            const scene::Collider& collider) {
  return least(model, [&](std::uint32_t cloth) { return contact_margin(scene, model, cloth, collider); });
}

void set_colliders(const gl::Program& program, const scene::Scene& scene, const model::Model& model,
                   const MotionTable& motions) {
  std::vector<glm::vec4> rows;  // those of each collider as shaders/collide/colliders.glsl has them
  for (std::size_t kind = 0; kind < scene::solid_kinds; ++kind)
    for (const scene::Collider& collider : scene.colliders) {
      if (collider.shape.index() != kind) continue;
      const scene::Solid solid = scene::solid(collider.shape);
      rows.emplace_back(glm::vec3(solid.point),
                        static_cast<float>(solid.radius + least_contact_margin(scene, model, collider)));
      rows.emplace_back(glm::vec3(solid.direction), static_cast<float>(solid.extent.x));
      rows.emplace_back(collider.friction, collider.restitution, motions.index(collider.motion),
                        solid.extent.y);
      if (elements::solid_has_axes(solid.kind))
        rows.emplace_back(glm::vec3(solid.second), static_cast<float>(solid.extent.z));
    }
  if (rows.empty()) return;
  glProgramUniform4fv(program.id(), program.location("solids"), static_cast<GLsizei>(rows.size()),
                      &rows[0].x);
  const GLint apart = program.location("cloths_apart");
  if (apart < 0) return;
  const std::vector<glm::vec2> cloths = cloths_apart(scene, model);
  glProgramUniform2fv(program.id(), apart, static_cast<GLsizei>(cloths.size()), &cloths[0].x);
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
