// Whom the hub has no place for, and why.
#include <algorithm>

#include "server/base/files.h"
#include "server/net/client.h"
#include "server/net/full_note.h"
#include "server/net/hub.h"
#include "server/net/request_headers.h"

namespace clothlab::net {

bool Hub::full(const std::string& address) const {
  const std::string network = network_of(address);
  return std::count_if(clients_.begin(), clients_.end(), [&](const auto& item) {
           return network_of(item.second->address()) == network;
         }) >= limits().clients_per_address;
}

std::string Hub::no_place(const std::string& session, const std::string& address) {
  const std::string network = network_of(address);
  if (elsewhere(session)) {
    const Result<std::string> note = read_file(lock_file(session));
    return refusal_by_note(note ? *note : std::string(), network);
  }
  const auto as_it_may = [](int most, const char* flag) {
    return " as it may, " + std::to_string(most) + "; see " + flag;
  };
  if (full(address)) {
    const int most = limits().clients_per_address;
    note_full(session, full_of_address(network, most));
    return "this address has as many clients" + as_it_may(most, "--max-clients-per-address");
  }
  if (full()) {
    note_full(session, full_of_clients(limits().clients));
    return "the server has as many clients" + as_it_may(limits().clients, "--max-clients");
  }
  if (!has_place_for(session))
    return "the server has as many sessions" + as_it_may(limits().sessions, "--max-sessions") +
           " (one that nobody has watched for " + std::to_string(limits().scene.unwatched_seconds) +
           " s makes room)";
  return {};
}

void Hub::note_full(const std::string& session, const std::string& line) {
  Room* room = options_.share_state ? find_room(session) : nullptr;
  if (!room) return;
  std::string& note = full_notes_[session];
  if (note.find(line) != std::string::npos) return;
  note += line;
  room->claim().write(note);
}

void Hub::forget_full() {
  for (const auto& [session, note] : full_notes_)
    if (Room* room = find_room(session)) room->claim().write({});
  full_notes_.clear();
}

}  // namespace clothlab::net
