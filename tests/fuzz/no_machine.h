// The server's protocol without what is below and beside it, for the target `dispatch`: a session that
// answers at once, on the caller's thread and without OpenGL; a lab that measures nothing; a network that is
// a list of messages.
#pragma once

#include <string>
#include <vector>

#include "server/session/exchange.h"

struct lws;

namespace clothlab::fuzz {

/// Lets every session carry out what it was asked. True if there was anything.
bool answer_commands();

/// What a client has been sent since the last call, oldest first; binary messages are left out.
std::vector<std::string> take_sent(const lws* wsi);

/// How the next piece of a message arrives.
struct Arrival {
  bool first = true, last = true, binary = false;
};
void set_arrival(const Arrival& arrival);

/// A connection's handle, until `disconnect`.
lws* connect();
void disconnect(lws* wsi);

/// Whether a client has told its connection to close, by a close frame.
bool close_was_said(const lws* wsi);

}  // namespace clothlab::fuzz
