#include "server/net/want_guard.h"

#include "server/relay/wire.h"

namespace clothlab::net {

namespace {

// A second, and at once.
constexpr double most_of_one = 6, burst_of_one = 24;
constexpr double most_strangers = 100, burst_of_strangers = 500;
constexpr double most_of_all = 1500, burst_of_all = 3000;
constexpr double most_kilobytes = 32 * 1024, burst_of_kilobytes = 128 * 1024;

}  // namespace

WantGuard::WantGuard(std::int64_t now)
    : strangers_(most_strangers, burst_of_strangers, now),
      all_(most_of_all, burst_of_all, now),
      kilobytes_(most_kilobytes, burst_of_kilobytes, now),
      forget_at_(now + relay::lease_us) {}

bool WantGuard::take(const std::string& reply, std::int64_t now) {
  if (now >= forget_at_) {
    std::erase_if(askers_, [now](const auto& item) { return now - item.second.last > relay::lease_us; });
    forget_at_ = now + relay::lease_us;
  }
  auto found = askers_.find(reply);
  if (found == askers_.end()) {
    if (askers_.size() >= relay::max_relays || !strangers_.take(now)) return false;
    found = askers_.emplace(reply, Asker{{most_of_one, burst_of_one, now}, now}).first;
  }
  if (!found->second.requests.take(now) || !all_.take(now)) return false;
  found->second.last = now;
  return true;
}

bool WantGuard::take_bytes(std::size_t bytes, std::int64_t now) {
  return kilobytes_.take(now, static_cast<double>(bytes) / 1024);
}

}  // namespace clothlab::net
