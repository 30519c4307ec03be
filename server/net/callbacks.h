// Where libwebsockets calls in: the protocols it may speak and what each event is passed on to.
#pragma once

struct lws_protocols;

namespace clothlab::net {

inline constexpr const char* subprotocol = "clothlab.v1";

const lws_protocols* protocols();

}  // namespace clothlab::net
