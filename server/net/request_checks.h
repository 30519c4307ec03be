// What is wrong with a request before it is asked what it wants: HTTP/1.1 (RFC 7230) and the WebSocket's
// handshake (RFC 6455), where libwebsockets is more lenient than they are.
#pragma once

#include <libwebsockets.h>

#include <optional>
#include <string>

namespace clothlab::net {

/// Of a request's known headers together; beyond: 431. Cookies of whatever else runs on localhost come along.
inline constexpr int max_header_bytes = 16 * 1024;
/// That libwebsockets reads at all; beyond: the connection is closed unanswered.
inline constexpr int header_room_bytes = 48 * 1024;

struct RequestFault {
  unsigned status;   ///< of HTTP
  std::string why;   ///< and what to do
  std::string also;  ///< a header line that the status asks for, or nothing
};

/// Nothing: the request is well-formed. After a fault the connection is closed: what follows could be part of
/// this one.
std::optional<RequestFault> request_fault(lws* wsi);
/// Of a request to become a WebSocket, well-formed as a request.
std::optional<RequestFault> handshake_fault(lws* wsi);

/// Whether a client that sent this Accept-Encoding would rather have gzip than no coding (RFC 7231, 5.3.4).
bool prefers_gzip(const std::string& accept_encoding);

}  // namespace clothlab::net
