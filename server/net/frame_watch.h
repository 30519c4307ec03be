// Finds unmasked frames from clients, which RFC 6455, 5.1 forbids. libwebsockets 4.1 to 4.3 accepts such
// frames and does not report them, so frame_watch.cpp inspects the bytes that libwebsockets reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

struct lws;

namespace clothlab::net {

/// Follows the frames in the bytes that come from one connection.
class FrameWatch {
 public:
  /// Inspects the next `size` bytes of the connection. An unmasked frame and all bytes after it are replaced
  /// by an empty masked frame, which has no effect. Returns the number of bytes then in `data`, which has
  /// space for `room` bytes.
  std::size_t filter(unsigned char* data, std::size_t size, std::size_t room);
  bool unmasked() const { return unmasked_; }

 private:
  std::uint64_t payload_ = 0;  ///< payload bytes still to come of the present frame
  std::array<unsigned char, 14> head_{};
  std::size_t head_bytes_ = 0;  ///< bytes of `head_` that have come
  bool unmasked_ = false;
};

/// Starts to watch a new connection, which sends an HTTP request first.
void watch_connection(int socket);
/// From here on the connection sends frames. False if the client has sent bytes after its handshake request
/// without waiting for the answer.
bool watch_frames(lws* wsi);
/// True if the connection has sent an unmasked frame. `wsi` becomes writeable when such a frame comes.
bool sent_unmasked(lws* wsi);
/// Stops watching the connection, which has ended.
void watch_no_longer(lws* wsi);

}  // namespace clothlab::net
