// What waits for a session, in order for each who asked, and in turns among them: who asks much waits for
// himself alone.
#pragma once

#include <cstdint>
#include <deque>
#include <map>

#include "server/session/command.h"

namespace clothlab::session {

class CommandQueue {
 public:
  /// What a client asks for. False: max_waiting_commands of its own wait already.
  [[nodiscard]] bool offer(Command command);
  /// What the server itself has to say; never refused. Of what viewers want and how many there are, only the
  /// newest waits.
  void post(Command command);
  bool empty() const { return turns_.empty(); }
  /// The next one of whoever's turn it is; the queue must not be empty.
  Command pop();

 private:
  std::deque<Command>& of(std::uint64_t asker);
  bool replace(const Command& newer);

  std::map<std::uint64_t, std::deque<Command>> waiting_;  ///< by who asked, none of them empty
  std::deque<std::uint64_t> turns_;                       ///< who has something waiting, next first
};

}  // namespace clothlab::session
