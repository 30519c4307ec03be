// Counts and limits the open connections, WebSockets and plain HTTP alike, in all and by the client's
// address; and tells clients that read slowly from those that read nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/net/limits.h"

struct lws;

namespace clothlab::net {

class Connections {
 public:
  /// Allows twice as many connections as WebSockets, by address and in all, which leaves half to plain HTTP.
  /// A proxy that is trusted has connections of many clients: only the limit of all holds for it.
  Connections(const Limits& limits, const std::vector<std::string>& trusted_proxies)
      : trusted_proxies_(trusted_proxies),
        most_(2 * static_cast<std::size_t>(limits.clients)),
        most_of_one_(2 * static_cast<std::size_t>(limits.clients_per_address)) {}

  bool full(const std::string& address) const;
  void opened(lws* wsi, const std::string& address);
  void closed(lws* wsi);
  std::size_t count() const { return open_.size(); }

  /// To be called once a second. Who has taken something of what is sent since the last call is not silent:
  /// limits of time begin anew, so that an answer or a message that takes long to send is sent whole.
  void excuse_slow_readers(int silence_seconds);

 private:
  struct Open {
    std::string network;
    std::uint64_t taken = 0;  ///< bytes that the client's system has acknowledged
  };
  std::vector<std::string> trusted_proxies_;
  std::size_t most_, most_of_one_;
  std::map<lws*, Open> open_;
  std::map<std::string, std::size_t> count_of_;
};

}  // namespace clothlab::net
