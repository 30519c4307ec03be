// The commands that wait for a session. Each client's commands stay in order, and clients take turns, so that
// a client that sends many commands delays only its own.
#pragma once

#include <cstdint>
#include <deque>
#include <map>

#include "server/session/command.h"

namespace clothlab::session {

class CommandQueue {
 public:
  /// Adds a client's command. A GrabMove without an id replaces one of the same hand that waits last. False:
  /// max_waiting_commands of this client wait already.
  [[nodiscard]] bool offer(Command command);
  /// Adds a command of the server itself; never refused. A new Demand or Watchers replaces the one that
  /// waits, but what that Demand wanted at once (`fresh`) is still wanted.
  void post(Command command);
  bool empty() const { return turns_.empty(); }
  /// Removes and returns the next command of the client whose turn it is. The queue must not be empty.
  Command pop();

 private:
  std::deque<Command>& of(std::uint64_t asker);
  bool replace(const Command& newer);
  bool replace_move(const Command& newer);

  std::map<std::uint64_t, std::deque<Command>> waiting_;  ///< by asker; no queue is empty
  std::deque<std::uint64_t> turns_;                       ///< askers with waiting commands, the next first
};

}  // namespace clothlab::session
