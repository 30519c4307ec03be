#include "server/net/token_guard.h"

namespace clothlab::net {

namespace {
constexpr std::int64_t second = 1'000'000;  // [us]
}  // namespace

int TokenGuard::wait(const std::string& address, std::int64_t now) const {
  const auto found = allowance_.find(address);
  if (found == allowance_.end()) return 0;
  return static_cast<int>((found->second.wait(now) + second - 1) / second);
}

void TokenGuard::was_wrong(const std::string& address, std::int64_t now) {
  // Addresses are forgotten at most once a second, as there may be many to look through.
  if (now >= forget_at_) {
    std::erase_if(allowance_, [now](const auto& item) { return item.second.full(now); });
    forget_at_ = now + second;
  }
  allowance_.try_emplace(address, wrong_a_minute_ / 60, wrong_a_minute_, now).first->second.take(now);
}

std::string token_wait_message(int seconds) {
  return "too many wrong tokens came from this address; no token from it is checked for " +
         std::to_string(seconds) + " s; see --max-wrong-tokens";
}

}  // namespace clothlab::net
