// The commands that wait for a session. Each client's commands stay in order. The next command is one of the
// client whose commands have taken least of the session's time, so that a client that asks for much delays
// its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

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
  bool empty() const { return waiting_.empty(); }
  /// Removes and returns the next command of the client whose turn it is. The queue must not be empty.
  Command pop();
  /// The last command popped has taken so long.
  void spent(std::chrono::nanoseconds time);
  /// Removes and returns what a client that has left still asks for. What lets the cloth go stays, and what
  /// is for others: files, jobs of the lab.
  std::vector<Command> drop(std::uint64_t asker);
  /// The commands that change the scene, of each client the next one.
  std::vector<const Command*> next_changes() const;

 private:
  struct Queue {
    std::chrono::nanoseconds used{};  ///< of the session's time, since nothing of the client waited
    std::uint64_t turn = 0;           ///< of two that have used the same, the lower is next
    std::deque<Command> commands{};
  };
  std::deque<Command>& of(std::uint64_t asker);
  bool replace(const Command& newer);
  bool replace_move(const Command& newer);

  std::map<std::uint64_t, Queue> waiting_;  ///< by asker; no queue is empty
  std::uint64_t turns_ = 0;
  std::uint64_t last_asker_ = 0;  ///< of the last command popped
};

}  // namespace clothlab::session
