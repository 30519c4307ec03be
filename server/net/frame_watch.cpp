// With _FORTIFY_SOURCE glibc's headers would define recv() inline; this file defines it.
#undef _FORTIFY_SOURCE

#include "server/net/frame_watch.h"

#include <dlfcn.h>
#include <libwebsockets.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <sys/types.h>

#include <algorithm>
#include <cstddef>
#include <unordered_map>

#include "server/net/head_watch.h"

namespace clothlab::net {

namespace {

struct Watched {
  HeadWatch heads;
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
  const auto size = static_cast<std::size_t>(got);
  if (!connection.wsi) return static_cast<long>(connection.heads.filter(data, size, room));
  const std::size_t left = connection.frames.filter(data, size, room);
  if (connection.frames.fault()) lws_callback_on_writable(connection.wsi);
  return static_cast<long>(left);
}

}  // namespace

const char* FrameWatch::fault_of_first(unsigned char byte) {
  const bool last = (byte & 0x80) != 0;
  const int opcode = byte & 0x0F;
  const bool control = opcode >= 8;
  if ((byte & 0x70) != 0) return "a client's frames have no reserved bit set (RFC 6455, 5.2)";
  if (opcode > (control ? 10 : 2)) return "there is no frame with this opcode (RFC 6455, 5.2)";
  if (control) return last ? nullptr : "a control frame comes in one piece (RFC 6455, 5.4)";
  if ((opcode == 0) != within_message_)
    return opcode == 0 ? "a continuation follows the beginning of a message (RFC 6455, 5.4)"
                       : "a message ends before the next one begins (RFC 6455, 5.4)";
  within_message_ = !last;
  return nullptr;
}

const char* FrameWatch::fault_of_second(unsigned char byte) const {
  if ((byte & 0x80) == 0) return "a client's frames are to be masked (RFC 6455, 5.1)";
  if ((head_[0] & 0x08) != 0 && (byte & 0x7F) > 125)
    return "a control frame has at most 125 bytes (RFC 6455, 5.5)";
  return nullptr;
}

std::size_t FrameWatch::filter(unsigned char* data, std::size_t size, std::size_t room) {
  constexpr std::array<unsigned char, 6> empty_pong{0x8A, 0x80, 0, 0, 0, 0};
  constexpr std::size_t mask_bytes = 4;
  // Replaces what comes from `from` on by the empty frame, without its first bytes, which were passed on.
  const auto replaced = [&](std::size_t from, std::size_t passed) {
    const std::size_t rest = std::min(empty_pong.size() - passed, room - from);
    std::copy_n(empty_pong.begin() + static_cast<std::ptrdiff_t>(passed), rest, data + from);
    return from + rest;
  };
  std::size_t at = 0;
  while (at < size && !fault_) {
    if (payload_ > 0) {
      const std::uint64_t here = std::min<std::uint64_t>(payload_, size - at);
      payload_ -= here;
      at += static_cast<std::size_t>(here);
      continue;
    }
    head_[head_bytes_++] = data[at++];
    if (head_bytes_ == 1 && (fault_ = fault_of_first(head_[0]))) return replaced(at - 1, 0);
    if (head_bytes_ < 2) continue;
    if (head_bytes_ == 2 && (fault_ = fault_of_second(head_[1]))) return replaced(at - 1, 1);
    const int length = head_[1] & 0x7F;
    const std::size_t length_bytes = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (head_bytes_ < 2 + length_bytes + mask_bytes) continue;
    payload_ = length_bytes == 0 ? static_cast<std::uint64_t>(length) : 0;
    for (std::size_t i = 0; i < length_bytes; ++i) payload_ = payload_ << 8 | head_[2 + i];
    head_bytes_ = 0;
  }
  return fault_ ? replaced(0, 0) : size;
}

void watch_connection(int socket) {
  watched()[socket] = {};
}

bool watch_frames(lws* wsi) {
  Watched& connection = watched()[lws_get_socket_fd(wsi)];
  connection.wsi = wsi;
  return !connection.heads.hurried();
}

bool head_malformed(lws* wsi) {
  const auto found = watched().find(lws_get_socket_fd(wsi));
  return found != watched().end() && found->second.heads.malformed();
}

const char* frame_fault(lws* wsi) {
  const auto found = watched().find(lws_get_socket_fd(wsi));
  return found != watched().end() && found->second.wsi == wsi ? found->second.frames.fault() : nullptr;
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
