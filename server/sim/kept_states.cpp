#include "server/sim/kept_states.h"

#include <glm/vec4.hpp>
#include <new>
#include <utility>

namespace clothlab::sim {

void KeptStates::keep(const StateBuffers& state, std::uint32_t vertex_count, KeptState when) {
  const std::size_t size = vertex_count * sizeof(glm::vec4);
  const auto take_the_oldest = [&] {
    when.position = std::move(states_.front().position);
    when.velocity = std::move(states_.front().velocity);
    drop_oldest();
  };
  if (!states_.empty() && (states_.size() >= most_states || bytes() + 2 * size > most_bytes)) {
    take_the_oldest();
  } else {
    try {
      when.position = gl::Buffer(size);
      when.velocity = gl::Buffer(size);
    } catch (const std::bad_alloc&) {  // a shorter timeline is no reason to fail
      if (states_.empty()) throw;
      take_the_oldest();
    }
  }
  state.save(when.position, when.velocity);
  states_.push_back(std::move(when));
}

const KeptState* KeptStates::at_or_before(std::uint64_t step) const {
  for (auto state = states_.rbegin(); state != states_.rend(); ++state)
    if (state->step <= step) return &*state;
  return nullptr;
}

std::size_t KeptStates::bytes() const {
  return states_.empty()
             ? 0
             : states_.size() * (states_.front().position.bytes() + states_.front().velocity.bytes());
}

void KeptStates::drop_after(std::uint64_t step) {
  while (!states_.empty() && states_.back().step > step) states_.pop_back();
}

}  // namespace clothlab::sim
