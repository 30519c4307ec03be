#include "server/net/service_time.h"

#include <algorithm>
#include <chrono>

#include "server/base/thread_clock.h"

namespace clothlab::net {

std::int64_t thread_time_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(ThreadClock::now().time_since_epoch()).count();
}

std::int64_t ServicePool::wait(const std::string& network, std::int64_t now) const {
  const auto found = of_network_.find(network);
  const std::int64_t own = found == of_network_.end() ? 0 : found->second.wait(now);
  return std::max(own, all_.wait(now));
}

void ServicePool::spend(const std::string& network, std::int64_t now, std::int64_t spent) {
  constexpr std::int64_t second = 1'000'000;  // [us]
  // Addresses are forgotten at most once a second, as there may be many to look through.
  if (now >= forget_at_) {
    std::erase_if(of_network_, [now](const auto& item) { return item.second.full(now); });
    forget_at_ = now + second;
  }
  const auto cost = static_cast<double>(spent);
  of_network_.try_emplace(network, each_.gained, each_.most, now).first->second.spend(now, cost);
  all_.spend(now, cost);
}

std::int64_t ServiceTime::wait(std::int64_t now) const {
  const std::int64_t own = own_.wait(now);
  return own == 0 ? 0 : std::min(own, pool_.wait(network_, now));
}

void ServiceTime::spend(std::int64_t now, std::int64_t spent) {
  if (own_.wait(now) == 0)
    own_.spend(now, static_cast<double>(spent));
  else
    pool_.spend(network_, now, spent);
}

}  // namespace clothlab::net
