// What a server that is full writes into the lock of a session that is open in it. The other servers that
// share the folder read it, so that a proxy which tries one of them after the first tells the client the true
// reason.
#pragma once

#include <string>

namespace clothlab::net {

/// A line of the note: no client more at all, of at most `most`.
std::string full_of_clients(int most);
/// A line of the note: no client more of this address, counted as network_of does.
std::string full_of_address(const std::string& network, int most);

/// Why another server refuses a client of this address for a session whose lock has this note.
std::string refusal_by_note(const std::string& note, const std::string& network);

}  // namespace clothlab::net
