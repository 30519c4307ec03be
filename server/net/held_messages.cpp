#include "server/net/held_messages.h"

namespace clothlab::net {

HeldMessages::Shared HeldMessages::hold(Shared message, std::size_t bytes) {
  std::erase_if(held_, [](const std::weak_ptr<const Held>& held) { return held.expired(); });
  for (const std::weak_ptr<const Held>& each : held_)
    if (const std::shared_ptr<const Held> held = each.lock(); held && held->message == message) return held;
  Result<MemoryBudget::Reservation> place =
      MemoryBudget::reserve(budget_, MemoryBudget::Use::downloads, bytes);
  if (!place) return nullptr;
  const auto held = std::make_shared<const Held>(Held{std::move(message), std::move(*place)});
  held_.push_back(held);
  return held;
}

}  // namespace clothlab::net
