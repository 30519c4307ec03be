#include "server/base/memory_budget.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "server/base/text.h"

namespace clothlab {

namespace {

constexpr double shares[MemoryBudget::uses] = {0.9, 0.25, 0.25, 0.125};
constexpr const char* use_names[MemoryBudget::uses] = {"simulations", "what sessions can go back to",
                                                       "recordings", "downloads"};

std::size_t index_of(MemoryBudget::Use use) {
  return static_cast<std::size_t>(use);
}

}  // namespace

std::string memory_text(std::uint64_t bytes) {
  const double of = static_cast<double>(bytes);
  return bytes < 1'000'000'000 ? formatted("%.0f MB", of / 1e6) : formatted("%.2f GB", of / 1e9);
}

std::shared_ptr<const std::string> held_text(std::string text, MemoryBudget::Reservation memory) {
  struct Held {
    MemoryBudget::Reservation memory;
    std::string text;
  };
  const auto both = std::make_shared<Held>(Held{std::move(memory), std::move(text)});
  return {both, &both->text};
}

std::shared_ptr<MemoryBudget> MemoryBudget::of(std::uint64_t total) {
  return std::shared_ptr<MemoryBudget>(new MemoryBudget(total));
}

std::uint64_t MemoryBudget::share(Use use) const {
  const std::uint64_t beside = total_ - std::min(total_, process_bytes);
  return static_cast<std::uint64_t>(shares[index_of(use)] * static_cast<double>(beside));
}

std::uint64_t MemoryBudget::used(Use use) const {
  const std::lock_guard lock(mutex_);
  return used_[index_of(use)];
}

std::uint64_t MemoryBudget::used() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(used_.begin(), used_.end(), process_bytes);
}

std::uint64_t MemoryBudget::left(Use use) const {
  const std::lock_guard lock(mutex_);
  return left_locked(use);
}

std::uint64_t MemoryBudget::left_locked(Use use) const {
  const std::uint64_t all = std::accumulate(used_.begin(), used_.end(), process_bytes);
  const std::uint64_t own = used_[index_of(use)];
  return std::min(total_ - std::min(total_, all), share(use) - std::min(share(use), own));
}

Status MemoryBudget::exchange(Use use, std::uint64_t before, std::uint64_t after) {
  const std::lock_guard lock(mutex_);
  if (after > before && after - before > left_locked(use))
    return Error{"memory",
                 memory_text(after) + " for " + use_names[index_of(use)] + ", where " +
                     memory_text(left_locked(use)) + " are left",
                 "at most " + memory_text(share(use)) + " of them, in a server of " + memory_text(total_) +
                     " (--max-memory)"};
  used_[index_of(use)] += after;
  used_[index_of(use)] -= before;
  return ok();
}

Result<MemoryBudget::Reservation> MemoryBudget::reserve(const std::shared_ptr<MemoryBudget>& budget, Use use,
                                                        std::uint64_t bytes) {
  Reservation made;
  made.budget_ = budget;
  made.use_ = use;
  if (Status done = made.resize(bytes); !done) return done.error();
  return made;
}

Status MemoryBudget::Reservation::resize(std::uint64_t bytes) {
  if (budget_)
    if (Status done = budget_->exchange(use_, bytes_, bytes); !done) return done;
  bytes_ = bytes;
  return ok();
}

void MemoryBudget::Reservation::give_back() {
  (void)resize(0);
  budget_.reset();
}

MemoryBudget::Reservation& MemoryBudget::Reservation::operator=(Reservation&& other) noexcept {
  if (this == &other) return *this;
  give_back();
  budget_ = std::move(other.budget_);
  use_ = other.use_;
  bytes_ = std::exchange(other.bytes_, 0);
  return *this;
}

}  // namespace clothlab
