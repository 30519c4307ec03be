// With _FORTIFY_SOURCE glibc's headers would define recv() inline; this file defines it.
#undef _FORTIFY_SOURCE

#include "server/net/frame_watch.h"

#include <dlfcn.h>
#include <libwebsockets.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/types.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <unordered_map>

namespace clothlab::net {

namespace {

struct Watched {
  std::string tail;    ///< the last bytes [at most 4] that came before the frames
  lws* wsi = nullptr;  ///< null until the connection sends frames
  FrameWatch frames;
};

/// The watched connections by socket. Each thread has its own map, filled only in the service thread, so that
/// reads in other threads pass unchanged.
std::unordered_map<int, Watched>& watched() {
  static thread_local std::unordered_map<int, Watched> all;
  return all;
}

long inspect_read(int socket, void* buffer, long got, std::size_t room) {
  const auto found = got > 0 ? watched().find(socket) : watched().end();
  if (found == watched().end()) return got;
  Watched& connection = found->second;
  auto* data = static_cast<unsigned char*>(buffer);
  if (connection.wsi) {
    const std::size_t left = connection.frames.filter(data, static_cast<std::size_t>(got), room);
    if (connection.frames.unmasked()) lws_callback_on_writable(connection.wsi);
    return static_cast<long>(left);
  }
  constexpr long end_of_head = 4;
  const long kept = std::min(got, end_of_head);
  connection.tail.append(reinterpret_cast<const char*>(data) + got - kept, static_cast<std::size_t>(kept));
  if (connection.tail.size() > end_of_head) connection.tail.erase(0, connection.tail.size() - end_of_head);
  return got;
}

}  // namespace

std::size_t FrameWatch::filter(unsigned char* data, std::size_t size, std::size_t room) {
  constexpr std::array<unsigned char, 6> empty_pong{0x8A, 0x80, 0, 0, 0, 0};
  constexpr std::size_t mask_bytes = 4;
  std::size_t at = 0;
  while (at < size && !unmasked_) {
    if (payload_ > 0) {
      const std::uint64_t here = std::min<std::uint64_t>(payload_, size - at);
      payload_ -= here;
      at += static_cast<std::size_t>(here);
      continue;
    }
    head_[head_bytes_++] = data[at++];
    if (head_bytes_ < 2) continue;
    if ((head_[1] & 0x80) == 0) {
      unmasked_ = true;
      // The head's first byte may have been passed on already: it stays, and an empty masked frame results.
      const std::size_t from = at - 1, rest = std::min(empty_pong.size() - 1, room - from);
      std::copy_n(empty_pong.begin() + 1, rest, data + from);
      return from + rest;
    }
    const int length = head_[1] & 0x7F;
    const std::size_t length_bytes = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (head_bytes_ < 2 + length_bytes + mask_bytes) continue;
    payload_ = length_bytes == 0 ? static_cast<std::uint64_t>(length) : 0;
    for (std::size_t i = 0; i < length_bytes; ++i) payload_ = payload_ << 8 | head_[2 + i];
    head_bytes_ = 0;
  }
  if (!unmasked_) return size;
  const std::size_t passed = std::min(empty_pong.size(), room);
  std::copy_n(empty_pong.begin(), passed, data);
  return passed;
}

void watch_connection(int socket) {
  watched()[socket] = {};
}

bool watch_frames(lws* wsi) {
  Watched& connection = watched()[lws_get_socket_fd(wsi)];
  connection.wsi = wsi;
  return connection.tail.ends_with("\r\n\r\n") || connection.tail.ends_with("\n\n");
}

bool sent_unmasked(lws* wsi) {
  const auto found = watched().find(lws_get_socket_fd(wsi));
  return found != watched().end() && found->second.wsi == wsi && found->second.frames.unmasked();
}

void watch_no_longer(lws* wsi) {
  std::erase_if(watched(), [wsi](const auto& item) { return item.second.wsi == wsi; });
}

}  // namespace clothlab::net

// libwebsockets reads with recv() and SSL_read(). The dynamic linker looks for them in the program before it
// looks in libraries, so libwebsockets calls these definitions.
extern "C" {

ssize_t recv(int socket, void* buffer, size_t size, int flags) {
  const ssize_t got = recvfrom(socket, buffer, size, flags, nullptr, nullptr);
  return (flags & MSG_PEEK) != 0 ? got : clothlab::net::inspect_read(socket, buffer, got, size);
}

int SSL_read(SSL* ssl, void* buffer, int size) {
  static const auto read = reinterpret_cast<int (*)(SSL*, void*, int)>(dlsym(RTLD_NEXT, "SSL_read"));
  static const auto socket_of = reinterpret_cast<int (*)(const SSL*)>(dlsym(RTLD_NEXT, "SSL_get_fd"));
  if (!read) return -1;
  const int got = read(ssl, buffer, size);
  if (got <= 0 || !socket_of) return got;
  return static_cast<int>(
      clothlab::net::inspect_read(socket_of(ssl), buffer, got, static_cast<std::size_t>(size)));
}
}
