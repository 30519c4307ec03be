// A large message counts once in the server's memory, however many clients are being sent it.
#include "server/net/held_messages.h"

#include <memory>
#include <string>

#include "tests/catch.h"

using namespace clothlab;

TEST_CASE("a message counts from the first client that takes a part of it to the last, and once") {
  const auto budget = MemoryBudget::of(MemoryBudget::least_bytes);
  constexpr auto use = MemoryBudget::Use::downloads;
  net::HeldMessages held(budget);
  const auto message = std::make_shared<const std::string>("a frame");
  auto first = held.hold(message, 1 << 20);
  auto second = held.hold(message, 1 << 20);
  CHECK(first);
  CHECK(first == second);
  CHECK(budget->used(use) == 1 << 20);
  const auto other = held.hold(std::make_shared<const std::string>("the next"), 1 << 20);
  CHECK(budget->used(use) == 2 << 20);
  CHECK_FALSE(held.hold(std::make_shared<const std::string>("too large"), budget->left(use) + 1));
  first.reset();
  CHECK(budget->used(use) == 2 << 20);
  second.reset();
  CHECK(budget->used(use) == 1 << 20);
  CHECK(message.use_count() == 1);
}
