#include "server/sim/kept_states.h"

#include <algorithm>
#include <iterator>
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
  while (!aside_.empty() && lacks_place(expected)) {
    aside_.pop_front();
    lost_aside_ = aside_.empty();
  }
  while (!states_.empty() && lacks_place(expected)) take_the_oldest();
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
  for (const std::deque<KeptState>* list : {&states_, &aside_})
    for (const KeptState& state : *list) sum += state.bytes();
  return sum;
}

bool KeptStates::lacks_place(std::size_t expected) const {
  return states_.size() + aside_.size() >= most_states || bytes() + expected > most;
}

void KeptStates::exchange_aside(std::uint64_t step) {
  std::deque<KeptState> others = std::exchange(aside_, {});
  lost_aside_ = false;
  const auto first = std::find_if(states_.begin(), states_.end(),
                                  [step](const KeptState& state) { return state.step > step; });
  aside_.assign(std::make_move_iterator(first), std::make_move_iterator(states_.end()));
  states_.erase(first, states_.end());
  states_.insert(states_.end(), std::make_move_iterator(others.begin()),
                 std::make_move_iterator(others.end()));
}

void KeptStates::drop_after(std::uint64_t step) {
  while (!states_.empty() && states_.back().step > step) states_.pop_back();
}

}  // namespace clothlab::sim
