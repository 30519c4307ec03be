#include "server/relay/audience.h"

#include <algorithm>

namespace clothlab::relay {

std::array<bool, form_count> Audience::heard(const Want& want, std::int64_t now) {
  std::array<bool, form_count> fresh{};
  const bool wanted = std::any_of(want.rates.begin(), want.rates.end(), [](double rate) { return rate > 0; });
  const auto found = relays_.find(want.relay);
  const Rates before = found != relays_.end() ? found->second.rates : Rates{};
  if (want.relay.empty() || (!wanted && want.viewers == 0)) {
    if (found != relays_.end()) relays_.erase(found);
    if (before != Rates{}) sum_up();
  } else if (found != relays_.end() || relays_.size() < max_relays) {
    Relay& relay = relays_[want.relay];
    for (std::size_t i = 0; i < form_count; ++i) {
      fresh[i] = want.rates[i] > 0 && relay.rates[i] <= 0;
      if (fresh[i]) lanes_[i] = {};
    }
    relay = {want.rates, std::max(want.viewers, wanted ? 1 : 0), now + lease_us};
    if (before != want.rates) sum_up();
  }
  return fresh;
}

bool Audience::forget_silent(std::int64_t now) {
  if (std::erase_if(relays_, [&](const auto& item) { return item.second.until < now; }) == 0) return false;
  sum_up();
  return true;
}

int Audience::viewers() const {
  int viewers = 0;
  for (const auto& [name, relay] : relays_) viewers += relay.viewers;
  return viewers;
}

void Audience::sum_up() {
  rates_ = {};
  for (const auto& [name, relay] : relays_)
    for (std::size_t i = 0; i < form_count; ++i) rates_[i] = std::max(rates_[i], relay.rates[i]);
}

bool Audience::due(stream::Form form, std::uint32_t sequence, std::int64_t now) {
  const double rate = rates_[form.index()];
  Lane& lane = lanes_[form.index()];
  if (rate <= 0 || now < lane.next || (lane.sent_any && lane.last == sequence)) return false;
  const auto period = static_cast<std::int64_t>(1e6 / rate);
  // At equal intervals; after a gap the intervals start anew.
  lane = {true, sequence, std::max(lane.next + period, now)};
  return true;
}

}  // namespace clothlab::relay
