// The large messages of which clients have taken a part. Who stops in the middle keeps the whole of it in
// memory, also when others have long had newer ones: each message counts once, however many are being sent
// it, among what the server's memory has for downloads.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "server/base/memory_budget.h"

namespace clothlab::net {

class HeldMessages {
 public:
  using Shared = std::shared_ptr<const void>;

  /// `budget` null: nothing is bounded.
  explicit HeldMessages(std::shared_ptr<MemoryBudget> budget) : budget_(std::move(budget)) {}
  /// To be kept while the message is being sent. Null: there is no memory for it.
  Shared hold(Shared message, std::size_t bytes);

 private:
  struct Held {
    Shared message;
    MemoryBudget::Reservation memory;
  };
  std::shared_ptr<MemoryBudget> budget_;
  std::vector<std::weak_ptr<const Held>> held_;
};

}  // namespace clothlab::net
