#include "server/sim/surface_bodies.h"

#include <algorithm>
#include <glm/vec4.hpp>

#include "server/sim/integrator.h"

namespace clothlab::sim {

Result<SurfaceBodies> SurfaceBodies::create(const model::Model& model, const Plan& plan,
                                            const SurfaceTriangles& surface) {
  SurfaceBodies made;
  made.places_ = surface.body_places;
  made.end_row_ = plan.pose_rows();
  if (made.places_.empty()) return made;
  Result<gl::Program> loaded = gl::Program::load({"surface/bodies.comp"}, step_defines(plan));
  if (!loaded) return loaded.error();
  made.program_ = std::move(*loaded);
  made.program_.set("cloth_vertex_count", static_cast<GLint>(model.vertex_count()));
  made.program_.set("vertex_count", static_cast<GLint>(model.vertex_count() + made.count()));
  return made;
}

void SurfaceBodies::set_parameters(const scene::Scene& scene, const model::Model& model,
                                   const MotionTable& motions) {
  // Boxes may be put elsewhere as the simulation runs.
  for (std::uint32_t i = 0; i < model.body_vertex_count(); ++i) places_[i].home = model.body_position[i];
  std::vector<glm::vec4> words;
  moves_ = false;
  for (const BodyPlace& place : places_) {
    const model::BodyRange& body = model.bodies[place.body];
    const scene::Collider& collider = scene.colliders[body.collider];
    const int motion = motions.index(body.motion);
    moves_ = moves_ || motion >= 0;
    words.emplace_back(glm::vec3(place.home), static_cast<float>(motion));
    const int first_of_box = body.box ? static_cast<int>(model.vertex_count() + body.first_vertex) : -1;
    words.emplace_back(collider.friction, collider.restitution, first_of_box, 0.0);
  }
  if (words.empty()) words.resize(1);
  buffer_ = {gl::Buffer(words), GL_RGBA32F};
}

void SurfaceBodies::place_at_start(const StateBuffers& state, int row) const {
  if (count() > 0 && changes()) place(state.position().buffer, state.velocity().buffer, row, 0);
}

void SurfaceBodies::place_at_end(const StateBuffers& state, int row) {
  if (count() > 0 && changes()) place(state.position().buffer, state.velocity().buffer, row, end_row_);
  steps_since_ = std::min(steps_since_ + 1, 2);
}

void SurfaceBodies::place(const gl::Buffer& position, const gl::Buffer& velocity, int start_row,
                          int row) const {
  bind();
  position.bind_storage(slot_next_position);
  velocity.bind_storage(slot_next_velocity);
  program_.use();
  program_.set("start_row", start_row);
  program_.set("row", row);
  glDispatchCompute(vertex_groups(count()), 1, 1);
  wait_for_writes();
}

}  // namespace clothlab::sim
