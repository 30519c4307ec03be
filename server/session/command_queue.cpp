#include "server/session/command_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "server/session/limits.h"

namespace clothlab::session {

namespace {

/// Whether a command is dropped when its client has left.
bool ends_with_client(const Command& command) {
  return !std::holds_alternative<GrabEnd>(command.what) && !std::holds_alternative<Export>(command.what) &&
         !std::holds_alternative<ReachScene>(command.what);
}

bool changes_scene(const Command& command) {
  return std::holds_alternative<PatchScene>(command.what) ||
         std::holds_alternative<LoadScene>(command.what) ||
         std::holds_alternative<UploadMesh>(command.what) ||
         std::holds_alternative<TravelHistory>(command.what);
}

}  // namespace

/// A client that comes now has used as much as the one that has used least.
std::deque<Command>& CommandQueue::of(std::uint64_t asker) {
  const auto found = waiting_.find(asker);
  if (found != waiting_.end()) return found->second.commands;
  Queue queue;
  if (!waiting_.empty())
    queue.used = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
                   return a.second.used < b.second.used;
                 })->second.used;
  queue.turn = ++turns_;
  return waiting_.emplace(asker, std::move(queue)).first->second.commands;
}

bool CommandQueue::offer(Command command) {
  if (replace_move(command)) return true;
  const auto found = waiting_.find(command.ticket.asker);
  if (found != waiting_.end() && found->second.commands.size() >= max_waiting_commands) return false;
  of(command.ticket.asker).push_back(std::move(command));
  return true;
}

void CommandQueue::post(Command command) {
  if (!replace(command)) of(command.ticket.asker).push_back(std::move(command));
}

/// Only the newest place of a hand counts. Moves of the client's other hands may stand between.
bool CommandQueue::replace_move(const Command& newer) {
  const auto* move = std::get_if<GrabMove>(&newer.what);
  const auto queue = waiting_.find(newer.ticket.asker);
  if (!move || newer.ticket.id || queue == waiting_.end()) return false;
  std::deque<Command>& commands = queue->second.commands;
  for (auto older = commands.rbegin(); older != commands.rend(); ++older) {
    auto* waits = std::get_if<GrabMove>(&older->what);
    if (!waits || older->ticket.id) return false;
    if (waits->hand != move->hand) continue;
    waits->target = move->target;
    return true;
  }
  return false;
}

bool CommandQueue::replace(const Command& newer) {
  if (!std::holds_alternative<Demand>(newer.what) && !std::holds_alternative<Watchers>(newer.what))
    return false;
  const auto queue = waiting_.find(newer.ticket.asker);
  if (queue == waiting_.end()) return false;
  std::deque<Command>& commands = queue->second.commands;
  const auto older = std::find_if(commands.begin(), commands.end(), [&](const Command& command) {
    return command.what.index() == newer.what.index();
  });
  if (older == commands.end()) return false;
  const auto* unmet = std::get_if<Demand>(&older->what);
  const auto fresh = unmet ? unmet->fresh : decltype(Demand::fresh){};
  older->what = newer.what;
  if (auto* demand = std::get_if<Demand>(&older->what))
    for (std::size_t i = 0; i < fresh.size(); ++i) demand->fresh[i] = demand->fresh[i] || fresh[i];
  return true;
}

Command CommandQueue::pop() {
  const auto next = std::min_element(waiting_.begin(), waiting_.end(), [](const auto& a, const auto& b) {
    return std::pair(a.second.used, a.second.turn) < std::pair(b.second.used, b.second.turn);
  });
  last_asker_ = next->first;
  Queue& queue = next->second;
  Command command = std::move(queue.commands.front());
  queue.commands.pop_front();
  queue.turn = ++turns_;
  if (queue.commands.empty()) waiting_.erase(next);
  return command;
}

void CommandQueue::spent(std::chrono::nanoseconds time) {
  if (const auto queue = waiting_.find(last_asker_); queue != waiting_.end()) queue->second.used += time;
}

std::vector<Command> CommandQueue::drop(std::uint64_t asker) {
  std::vector<Command> dropped;
  const auto queue = waiting_.find(asker);
  if (queue == waiting_.end()) return dropped;
  std::deque<Command>& commands = queue->second.commands;
  const auto from = std::stable_partition(commands.begin(), commands.end(),
                                          [](const Command& command) { return !ends_with_client(command); });
  std::move(from, commands.end(), std::back_inserter(dropped));
  commands.erase(from, commands.end());
  if (commands.empty()) waiting_.erase(queue);
  return dropped;
}

std::vector<const Command*> CommandQueue::next_changes() const {
  std::vector<const Command*> changes;
  for (const auto& [asker, queue] : waiting_) {
    const auto next = std::find_if(queue.commands.begin(), queue.commands.end(), changes_scene);
    if (next != queue.commands.end()) changes.push_back(&*next);
  }
  return changes;
}

}  // namespace clothlab::session
