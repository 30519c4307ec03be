#include "server/net/connections.h"

#include <algorithm>

#include "server/net/request_headers.h"

namespace clothlab::net {

bool Connections::full(const std::string& address) const {
  if (network_of_connection_.size() >= most_) return true;
  if (std::find(trusted_proxies_.begin(), trusted_proxies_.end(), address) != trusted_proxies_.end())
    return false;
  const auto found = count_of_.find(network_of(address));
  return found != count_of_.end() && found->second >= most_of_one_;
}

void Connections::opened(lws* wsi, const std::string& address) {
  const std::string network = network_of(address);
  if (network_of_connection_.emplace(wsi, network).second) ++count_of_[network];
}

void Connections::closed(lws* wsi) {
  const auto found = network_of_connection_.find(wsi);
  if (found == network_of_connection_.end()) return;
  if (const auto counted = count_of_.find(found->second); --counted->second == 0) count_of_.erase(counted);
  network_of_connection_.erase(found);
}

}  // namespace clothlab::net
