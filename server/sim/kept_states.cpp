#include "server/sim/kept_states.h"

#include <new>
#include <utility>

namespace clothlab::sim {

void KeptStates::keep(const std::function<void(KeptState&)>& copy) {
  KeptState next;
  const auto take_the_oldest = [&] {
    next = std::move(states_.front());
    drop_oldest();
  };
  const std::size_t expected = states_.empty() ? 0 : states_.back().bytes();
  while (!states_.empty() && (states_.size() >= most_states || bytes() + expected > most)) take_the_oldest();
  try {
    copy(next);
  } catch (const std::bad_alloc&) {  // a shorter timeline is no reason to fail
    if (states_.empty()) throw;
    take_the_oldest();
    copy(next);
  }
  states_.push_back(std::move(next));
  after_step = false;
}

const KeptState* KeptStates::at_or_before(std::uint64_t step) const {
  for (auto state = states_.rbegin(); state != states_.rend(); ++state)
    if (state->step <= step) return &*state;
  return nullptr;
}

std::size_t KeptStates::bytes() const {
  std::size_t sum = 0;
  for (const KeptState& state : states_) sum += state.bytes();
  return sum;
}

void KeptStates::drop_after(std::uint64_t step) {
  while (!states_.empty() && states_.back().step > step) states_.pop_back();
}

}  // namespace clothlab::sim
