#include "server/sim/scene_order.h"

#include <glm/vec4.hpp>
#include <string>
#include <utility>

#include "server/sim/integrator.h"

namespace clothlab::sim {

Result<SceneOrder> SceneOrder::create(const std::vector<std::uint32_t>& places) {
  SceneOrder order;
  if (places.empty()) return order;
  Result<gl::Program> copy =
      gl::Program::load({"stream/scene_order.comp"}, {{"GROUP_SIZE", std::to_string(group_size)}});
  if (!copy) return copy.error();
  order.copy_ = std::move(*copy);
  order.copy_.set("vertex_count", static_cast<GLint>(places.size()));
  order.place_texels_ = {gl::Buffer(places), GL_R32UI};
  order.in_scene_ = {gl::Buffer(places.size() * sizeof(glm::vec4)), GL_RGBA32F};
  order.places_ = places;
  return order;
}

State SceneOrder::to_scene(State in_memory) const {
  if (places_.empty()) return in_memory;
  State state = in_memory;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    state.position[i] = in_memory.position[places_[i]];
    state.velocity[i] = in_memory.velocity[places_[i]];
  }
  return state;
}

State SceneOrder::to_memory(State in_scene) const {
  if (places_.empty()) return in_scene;
  State state = in_scene;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    state.position[places_[i]] = in_scene.position[i];
    state.velocity[places_[i]] = in_scene.velocity[i];
  }
  return state;
}

const gl::TextureBuffer& SceneOrder::to_scene(const gl::TextureBuffer& in_memory) const {
  if (places_.empty()) return in_memory;
  copy_.use();
  in_memory.bind(unit_position);
  place_texels_.bind(unit_places);
  in_scene_.buffer.bind_storage(slot_in_scene_order);
  glDispatchCompute(vertex_groups(static_cast<std::uint32_t>(places_.size())), 1, 1);
  wait_for_writes();
  return in_scene_;
}

}  // namespace clothlab::sim
