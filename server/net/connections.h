// Counts and limits the open connections, WebSockets and plain HTTP alike, in all and by the client's
// address.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "server/net/limits.h"

struct lws;

namespace clothlab::net {

class Connections {
 public:
  /// Allows twice as many connections as WebSockets, by address and in all, which leaves half to plain HTTP.
  explicit Connections(const Limits& limits)
      : most_(2 * static_cast<std::size_t>(limits.clients)),
        most_of_one_(2 * static_cast<std::size_t>(limits.clients_per_address)) {}

  bool full(const std::string& address) const;
  void opened(lws* wsi, const std::string& address);
  void closed(lws* wsi);
  std::size_t count() const { return address_of_.size(); }

 private:
  std::size_t most_, most_of_one_;
  std::map<lws*, std::string> address_of_;
  std::map<std::string, std::size_t> count_of_;
};

}  // namespace clothlab::net
