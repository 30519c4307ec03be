// Checks a request's form before its content is handled: HTTP/1.1 (RFC 7230) and the WebSocket handshake
// (RFC 6455), where libwebsockets is more lenient than these RFCs.
#pragma once

#include <libwebsockets.h>

#include <optional>
#include <string>

namespace clothlab::net {

/// The most bytes that a request's known headers may have together; beyond: 431. They include the cookies of
/// other programs on localhost.
inline constexpr int max_header_bytes = 16 * 1024;
/// The most bytes of headers that libwebsockets reads; beyond: the connection is closed without an answer.
inline constexpr int header_room_bytes = 48 * 1024;

struct RequestFault {
  unsigned status;           ///< HTTP status to answer with
  std::string why;           ///< what is wrong, and what to do
  std::string extra_header;  ///< a header line that the status requires; empty: none
};

/// The first fault of a request; empty: the request is well-formed. After a fault the connection must be
/// closed, because the bytes that follow could be part of this request.
std::optional<RequestFault> request_fault(lws* wsi);
/// The first fault of a WebSocket handshake that has no request_fault; empty: the handshake is well-formed.
std::optional<RequestFault> handshake_fault(lws* wsi);

enum class Coding { identity, gzip, brotli };

/// The coding that a client which sent this Accept-Encoding prefers (RFC 7231, 5.3.4); of those that it likes
/// equally the one that takes fewest bytes. Brotli only if it is `there`, and the client names it.
Coding preferred_coding(const std::string& accept_encoding, bool brotli_there);

}  // namespace clothlab::net
