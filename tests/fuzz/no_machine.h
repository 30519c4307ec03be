// The server's protocol without the parts below and beside it, for the target `dispatch`: a session answers
// at once, on the caller's thread and without OpenGL; a lab measures nothing; a network is a list of
// messages.
#pragma once

#include <string>
#include <vector>

#include "server/session/exchange.h"

struct lws;

namespace clothlab::fuzz {

/// Lets every session carry out its commands. True if there were any.
bool answer_commands();

/// Messages sent to a client since the last call, oldest first, without binary messages.
std::vector<std::string> take_sent(const lws* wsi);

/// Form in which the next piece of a message arrives.
struct Arrival {
  bool first = true, last = true, binary = false;
};
void set_arrival(const Arrival& arrival);

/// Makes a connection's handle, valid until `disconnect`.
lws* connect();
void disconnect(lws* wsi);

/// True if a client has told its connection to close, by a close frame.
bool close_was_said(const lws* wsi);

}  // namespace clothlab::fuzz
