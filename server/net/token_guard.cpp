#include "server/net/token_guard.h"

namespace clothlab::net {

namespace {
constexpr std::int64_t second = 1'000'000;  // [us]
}  // namespace

int TokenGuard::wait(const std::string& address, std::int64_t now) const {
  const auto found = left_.find(address);
  if (found == left_.end()) return 0;
  return static_cast<int>((found->second.wait(now) + second - 1) / second);
}

void TokenGuard::was_wrong(const std::string& address, std::int64_t now) {
  // Addresses are forgotten at most once a second, as there may be many to look through.
  if (now >= forget_at_) {
    std::erase_if(left_, [now](const auto& item) { return item.second.full(now); });
    forget_at_ = now + second;
  }
  left_.try_emplace(address, most_ / 60, most_, now).first->second.take(now);
}

std::string not_looked_at(int seconds) {
  return "too many wrong tokens came from this address; none is looked at for " + std::to_string(seconds) +
         " s; see --max-wrong-tokens";
}

}  // namespace clothlab::net
