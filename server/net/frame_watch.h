// Sees to it that clients mask their frames (RFC 6455, 5.1): libwebsockets, 4.1 to 4.3, takes them either way
// and tells nobody which it was. So what it reads is looked at as it is read, see frame_watch.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

struct lws;

namespace clothlab::net {

/// Follows one connection's bytes from frame to frame.
class FrameWatch {
 public:
  /// Looks at `size` bytes that have come; where an unmasked frame begins among them, it and all that follows
  /// is replaced by an empty masked frame, which makes libwebsockets do nothing. How many bytes there are
  /// then, at most `room` of them.
  std::size_t pass(unsigned char* data, std::size_t size, std::size_t room);
  bool unmasked() const { return unmasked_; }

 private:
  std::uint64_t payload_ = 0;  ///< bytes still to come of a frame whose head has come
  std::array<unsigned char, 14> head_{};
  std::size_t head_bytes_ = 0;  ///< that have come
  bool unmasked_ = false;
};

/// A new connection: nothing it sends is a frame yet.
void watch_connection(int socket);
/// From here on it sends frames. False: something has come after the handshake's request already, before its
/// answer.
bool watch_frames(lws* wsi);
/// Whether it has sent an unmasked frame; `wsi` becomes writeable when it does.
bool sent_unmasked(lws* wsi);
/// It has ended.
void watch_no_longer(lws* wsi);

}  // namespace clothlab::net
