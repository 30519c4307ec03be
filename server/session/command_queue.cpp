#include "server/session/command_queue.h"

#include <algorithm>
#include <utility>

#include "server/session/limits.h"

namespace clothlab::session {

std::deque<Command>& CommandQueue::of(std::uint64_t asker) {
  const auto [found, first] = waiting_.try_emplace(asker);
  if (first) turns_.push_back(asker);
  return found->second;
}

bool CommandQueue::offer(Command command) {
  if (replace_move(command)) return true;
  const auto found = waiting_.find(command.ticket.asker);
  if (found != waiting_.end() && found->second.size() >= max_waiting_commands) return false;
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
  for (auto older = queue->second.rbegin(); older != queue->second.rend(); ++older) {
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
  const auto older = std::find_if(queue->second.begin(), queue->second.end(), [&](const Command& command) {
    return command.what.index() == newer.what.index();
  });
  if (older == queue->second.end()) return false;
  const auto* unmet = std::get_if<Demand>(&older->what);
  const auto fresh = unmet ? unmet->fresh : decltype(Demand::fresh){};
  older->what = newer.what;
  if (auto* demand = std::get_if<Demand>(&older->what))
    for (std::size_t i = 0; i < fresh.size(); ++i) demand->fresh[i] = demand->fresh[i] || fresh[i];
  return true;
}

Command CommandQueue::pop() {
  const std::uint64_t asker = turns_.front();
  turns_.pop_front();
  const auto queue = waiting_.find(asker);
  Command next = std::move(queue->second.front());
  queue->second.pop_front();
  if (queue->second.empty())
    waiting_.erase(queue);
  else
    turns_.push_back(asker);
  return next;
}

}  // namespace clothlab::session
