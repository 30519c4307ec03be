// The callbacks of libwebsockets: the protocols it serves and the object that handles each event.
#pragma once

struct lws_protocols;

namespace clothlab::net {

inline constexpr const char* subprotocol = "clothlab.v1";

const lws_protocols* protocols();

}  // namespace clothlab::net
