#include "server/sim/state.h"

#include <glm/vec4.hpp>
#include <utility>

#include "server/sim/motion_table.h"

namespace clothlab::sim {

namespace {

struct Arrays {
  std::vector<glm::vec4> position, velocity;
};

std::size_t bytes(const model::Model& model) {
  return model.vertex_count() * sizeof(glm::vec4);
}

/// Sets the fourth components (see state.h) from the model. A vertex that stays free keeps its contact count.
void set_constants(Arrays& arrays, const model::Model& model, const MotionTable& motions) {
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i) {
    const std::int32_t pin = model.pin_motion[i];
    const bool was_pinned = arrays.position[i].w == 0.0f, pinned = pin != model::not_pinned;
    arrays.position[i].w = pinned ? 0.0f : static_cast<float>(1.0 / model.mass[i]);
    if (pinned)
      arrays.velocity[i].w = static_cast<float>(motions.index(model.motions[static_cast<std::size_t>(pin)]));
    else if (was_pinned)
      arrays.velocity[i].w = 0.0f;
  }
}

Arrays at_rest(const model::Model& model, const MotionTable& motions) {
  Arrays arrays;
  for (const glm::dvec3& start : model.start_position) arrays.position.emplace_back(glm::vec3(start), 0.0f);
  arrays.velocity.assign(model.vertex_count(), glm::vec4(0.0f));
  set_constants(arrays, model, motions);
  return arrays;
}

}  // namespace

StateBuffers::StateBuffers(const model::Model& model, const MotionTable& motions, std::uint32_t extra)
    : vertex_count_(model.vertex_count()) {
  for (gl::TextureBuffer* buffer : {&position_[0], &position_[1], &velocity_[0], &velocity_[1]})
    *buffer = {gl::Buffer(bytes(model) + extra * sizeof(glm::vec4)), GL_RGBA32F};
  reset(model, motions);
}

void StateBuffers::make_room(std::uint32_t extra) {
  const std::size_t wanted = (vertex_count_ + extra) * sizeof(glm::vec4);
  if (wanted <= position().buffer.bytes()) return;
  for (gl::TextureBuffer* buffer : {&position_[0], &position_[1], &velocity_[0], &velocity_[1]}) {
    gl::TextureBuffer larger{gl::Buffer(wanted), GL_RGBA32F};
    larger.buffer.copy_from(buffer->buffer);
    *buffer = std::move(larger);
  }
}

void StateBuffers::copy_from(const StateBuffers& other) {
  vertex_count_ = other.vertex_count_;
  const std::size_t size = other.position().buffer.bytes();
  for (gl::TextureBuffer* buffer : {&position_[0], &position_[1], &velocity_[0], &velocity_[1]})
    if (buffer->buffer.bytes() != size) *buffer = {gl::Buffer(size), GL_RGBA32F};
  position_[current_].buffer.copy_from(other.position().buffer);
  velocity_[current_].buffer.copy_from(other.velocity().buffer);
}

void StateBuffers::show() {
  shown_ = current_;
  is_aside_ = false;
}

void StateBuffers::put_aside() {
  if (aside_position_.buffer.bytes() == 0)
    for (gl::TextureBuffer* buffer : {&aside_position_, &aside_velocity_})
      *buffer = {gl::Buffer(vertex_count_ * sizeof(glm::vec4)), GL_RGBA32F};
  save(aside_position_.buffer, aside_velocity_.buffer);
  is_aside_ = true;
}

void StateBuffers::give_up_step() {
  current_ = shown_;
  if (std::exchange(is_aside_, false)) load(aside_position_.buffer, aside_velocity_.buffer);
}

void StateBuffers::reset(const model::Model& model, const MotionTable& motions) {
  const Arrays arrays = at_rest(model, motions);
  position_[current_].buffer.upload(arrays.position.data(), bytes(model));
  velocity_[current_].buffer.upload(arrays.velocity.data(), bytes(model));
}

void StateBuffers::write(const State& state, const model::Model& model, const MotionTable& motions) {
  Arrays arrays;
  for (const glm::vec3& position : state.position) arrays.position.emplace_back(position, 0.0f);
  for (const glm::vec3& velocity : state.velocity) arrays.velocity.emplace_back(velocity, 0.0f);
  set_constants(arrays, model, motions);
  position_[current_].buffer.upload(arrays.position.data(), bytes(model));
  velocity_[current_].buffer.upload(arrays.velocity.data(), bytes(model));
}

void StateBuffers::rewrite_constants(const model::Model& model, const MotionTable& motions) {
  Arrays arrays{std::vector<glm::vec4>(model.vertex_count()), std::vector<glm::vec4>(model.vertex_count())};
  position().buffer.download(arrays.position.data(), bytes(model));
  velocity().buffer.download(arrays.velocity.data(), bytes(model));
  set_constants(arrays, model, motions);
  position_[current_].buffer.upload(arrays.position.data(), bytes(model));
  velocity_[current_].buffer.upload(arrays.velocity.data(), bytes(model));
}

void StateBuffers::save(gl::Buffer& position, gl::Buffer& velocity) const {
  position.copy_from(shown_position().buffer);
  velocity.copy_from(shown_velocity().buffer);
}

void StateBuffers::load(const gl::Buffer& position, const gl::Buffer& velocity) {
  position_[current_].buffer.copy_from(position);
  velocity_[current_].buffer.copy_from(velocity);
}

void StateBuffers::bind_for_step() const {
  position_[current_].bind(unit_position);
  velocity_[current_].bind(unit_velocity);
  bind_outputs();
}

void StateBuffers::bind_outputs() const {
  position_[1 - current_].buffer.bind_storage(slot_next_position);
  velocity_[1 - current_].buffer.bind_storage(slot_next_velocity);
}

State StateBuffers::read() const {
  const std::size_t count = vertex_count_;
  std::vector<glm::vec4> words(count);
  State state;
  shown_position().buffer.download(words.data(), count * sizeof(glm::vec4));
  for (const glm::vec4& word : words) state.position.emplace_back(word);
  shown_velocity().buffer.download(words.data(), count * sizeof(glm::vec4));
  for (const glm::vec4& word : words) state.velocity.emplace_back(word);
  return state;
}

std::uint64_t state_hash(const State& state) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::vector<glm::vec3>* values : {&state.position, &state.velocity}) {
    const auto* byte = reinterpret_cast<const unsigned char*>(values->data());
    for (std::size_t i = 0; i < values->size() * sizeof(glm::vec3); ++i)
      hash = (hash ^ byte[i]) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace clothlab::sim
