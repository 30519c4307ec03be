#include "server/net/connections.h"

namespace clothlab::net {

bool Connections::full(const std::string& address) const {
  if (address_of_.size() >= most_) return true;
  const auto found = count_of_.find(address);
  return found != count_of_.end() && found->second >= most_of_one_;
}

void Connections::opened(lws* wsi, const std::string& address) {
  if (address_of_.emplace(wsi, address).second) ++count_of_[address];
}

void Connections::closed(lws* wsi) {
  const auto found = address_of_.find(wsi);
  if (found == address_of_.end()) return;
  if (const auto counted = count_of_.find(found->second); --counted->second == 0) count_of_.erase(counted);
  address_of_.erase(found);
}

}  // namespace clothlab::net
