// Memory for contact's lists, which become longer while a simulation runs than what its scene was expected to
// take (memory.h) allows for: reserved before they grow, so that what does not fit is refused.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include "server/base/memory_budget.h"

namespace clothlab::sim {

class ListMemory {
 public:
  /// `budget` null: nothing is bounded.
  explicit ListMemory(std::shared_ptr<MemoryBudget> budget) : budget_(std::move(budget)) {}

  /// That of the simulations which the calling thread makes from then on; null: their lists are not bounded.
  static std::shared_ptr<ListMemory>& of_thread() {
    thread_local std::shared_ptr<ListMemory> memory;
    return memory;
  }

  /// Makes a list's reservation as large as this; one without a budget yet gets this one's. False: there is
  /// not so much, and the list has to stay as it is.
  bool resize(MemoryBudget::Reservation& list, std::size_t bytes) {
    if (list.bytes() == 0)
      if (auto empty = MemoryBudget::reserve(budget_, MemoryBudget::Use::simulations, 0))
        list = std::move(*empty);
    const Status done = list.resize(bytes);
    if (!done) refusal_ = done.error().text();
    return static_cast<bool>(done);
  }
  /// Why a list could not grow since the last call, for users; empty: all could.
  std::string take_refusal() { return std::exchange(refusal_, {}); }

 private:
  std::shared_ptr<MemoryBudget> budget_;
  std::string refusal_;
};

}  // namespace clothlab::sim
