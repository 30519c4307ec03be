#include "server/net/connections.h"

#include <libwebsockets.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "server/net/request_headers.h"

namespace clothlab::net {

namespace {

/// Bytes that the other end has acknowledged: tcpi_bytes_acked of Linux's struct tcp_info, whose places never
/// change. The struct of glibc 2.36 ends before it.
std::uint64_t taken_of(int socket) {
  constexpr std::size_t place = 120;
  std::array<char, place + sizeof(std::uint64_t)> info{};
  socklen_t size = info.size();
  std::uint64_t taken = 0;
  if (getsockopt(socket, IPPROTO_TCP, TCP_INFO, info.data(), &size) == 0)
    std::memcpy(&taken, info.data() + place, sizeof taken);
  return taken;
}

bool has_unsent(int socket) {
  int bytes = 0;
  return ioctl(socket, SIOCOUTQ, &bytes) == 0 && bytes > 0;
}

}  // namespace

bool Connections::full(const std::string& address) const {
  if (open_.size() >= most_) return true;
  if (std::find(trusted_proxies_.begin(), trusted_proxies_.end(), address) != trusted_proxies_.end())
    return false;
  const auto found = count_of_.find(network_of(address));
  return found != count_of_.end() && found->second >= most_of_one_;
}

void Connections::opened(lws* wsi, const std::string& address) {
  const std::string network = network_of(address);
  if (open_.try_emplace(wsi, Open{network}).second) ++count_of_[network];
}

void Connections::closed(lws* wsi) {
  const auto found = open_.find(wsi);
  if (found == open_.end()) return;
  if (const auto counted = count_of_.find(found->second.network); --counted->second == 0)
    count_of_.erase(counted);
  open_.erase(found);
}

// What a client takes is what its system acknowledges: the socket may have room for more only once in a
// megabyte. Of WebSockets only a long message is looked at, behind which no ping can be sent.
void Connections::excuse_slow_readers(int silence_seconds) {
  for (auto& [wsi, open] : open_) {
    const lws_protocols* protocol = lws_get_protocol(wsi);
    const bool http = protocol && std::strcmp(protocol->name, "http") == 0;
    const int socket = lws_get_socket_fd(wsi);
    if (!lws_partial_buffered(wsi) && !(http && has_unsent(socket))) continue;
    const std::uint64_t taken = taken_of(socket);
    if (std::exchange(open.taken, taken) == taken) continue;
    if (http)
      lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, silence_seconds);
    else
      lws_validity_confirmed(wsi);
  }
}

}  // namespace clothlab::net
