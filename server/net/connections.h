// The open sockets, of WebSockets and plain HTTP alike, by the address at the other end: how many there may
// be.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "server/net/limits.h"

struct lws;

namespace clothlab::net {

class Connections {
 public:
  /// As many again as there may be WebSockets, for plain HTTP: of one address, and in all.
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
