#include "server/sim/last_good.h"

#include <glm/vec4.hpp>
#include <utility>

namespace clothlab::sim {

LastGood::LastGood(std::uint32_t vertex_count) {
  for (Copy* copy : {&aside_, &good_}) {
    copy->position = gl::Buffer(vertex_count * sizeof(glm::vec4));
    copy->velocity = gl::Buffer(vertex_count * sizeof(glm::vec4));
  }
}

void LastGood::put_aside(const StateBuffers& state, double time, std::uint64_t step) {
  state.save(aside_.position, aside_.velocity);
  aside_.when = {time, step};
}

void LastGood::keep(std::uint64_t step) {
  if (aside_.when.step == step) std::swap(aside_, good_);
}

LastGood::When LastGood::restore(StateBuffers& state) const {
  state.load(good_.position, good_.velocity);
  return good_.when;
}

}  // namespace clothlab::sim
