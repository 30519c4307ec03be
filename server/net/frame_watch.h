// Finds what RFC 6455 forbids in the frames of clients. libwebsockets 4.1 to 4.3 accepts unmasked frames and
// does not report them; other faults it answers itself, and sends on after its close frame. So
// frame_watch.cpp inspects the bytes that libwebsockets reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

struct lws;

namespace clothlab::net {

/// Follows the frames in the bytes that come from one connection.
class FrameWatch {
 public:
  /// Inspects the next `size` bytes of the connection. A frame that is not allowed and all bytes after it are
  /// replaced by an empty masked frame, which has no effect. Returns the number of bytes then in `data`,
  /// which has space for `room` bytes.
  std::size_t filter(unsigned char* data, std::size_t size, std::size_t room);
  /// What is wrong with the first frame that is not allowed; null: there was none.
  const char* fault() const { return fault_; }

 private:
  const char* fault_of_first(unsigned char byte);
  const char* fault_of_second(unsigned char byte) const;

  std::uint64_t payload_ = 0;  ///< payload bytes still to come of the present frame
  std::array<unsigned char, 14> head_{};
  std::size_t head_bytes_ = 0;   ///< bytes of `head_` that have come
  bool within_message_ = false;  ///< the last piece of a message is still to come
  const char* fault_ = nullptr;
};

/// Starts to watch a new connection, which sends an HTTP request first.
void watch_connection(int socket);
/// From here on the connection sends frames. False if the client has sent bytes after its handshake request
/// without waiting for the answer.
bool watch_frames(lws* wsi);
/// True if a line of the connection's requests was no header.
bool head_malformed(lws* wsi);
/// What is wrong with a frame that the connection has sent; null: nothing. `wsi` becomes writeable when such
/// a frame comes.
const char* frame_fault(lws* wsi);
/// Stops watching the connection, which has ended.
void watch_no_longer(lws* wsi);

}  // namespace clothlab::net
