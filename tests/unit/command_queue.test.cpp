// A client that asks a session for much delays only itself.
#include "server/session/command_queue.h"

#include "server/session/limits.h"
#include "tests/catch.h"

using namespace clothlab;
using session::Command;
using session::CommandQueue;
using session::GrabEnd;
using session::GrabMove;

namespace {

std::uint64_t asker_of_next(CommandQueue& queue) {
  return queue.pop().ticket.asker;
}

session::Ticket by(std::uint64_t asker) {
  session::Ticket ticket;
  ticket.asker = asker;
  return ticket;
}

session::Demand demand(double rate, bool fresh) {
  return {{rate, 0}, {fresh, false}};
}

}  // namespace

TEST_CASE(
    "a client may have max_waiting_commands waiting, whatever the others have, and the server always more") {
  CommandQueue queue;
  for (std::size_t i = 0; i < session::max_waiting_commands; ++i)
    REQUIRE(queue.offer({by(1), session::Play{}}));
  CHECK_FALSE(queue.offer({by(1), session::Play{}}));
  CHECK(queue.offer({by(2), session::Play{}}));
  for (std::size_t i = 0; i < 2 * session::max_waiting_commands; ++i) queue.post({{}, session::Release{}});
  CHECK(asker_of_next(queue) == 1);
  CHECK(queue.offer({by(1), session::Play{}}));
}

TEST_CASE("clients take turns, and each one's commands keep their order") {
  CommandQueue queue;
  for (std::size_t i = 0; i < 100; ++i) REQUIRE(queue.offer({by(1), session::Step{i}}));
  REQUIRE(queue.offer({by(2), session::Step{7}}));
  REQUIRE(queue.offer({by(2), session::Step{8}}));
  REQUIRE(queue.offer({by(3), session::Step{9}}));
  std::vector<std::uint64_t> askers, of_two;
  std::size_t of_one = 0;
  while (!queue.empty()) {
    const session::Command command = queue.pop();
    const std::size_t step = std::get<session::Step>(command.what).steps;
    askers.push_back(command.ticket.asker);
    if (command.ticket.asker == 1) CHECK(step == of_one++);
    if (command.ticket.asker == 2) of_two.push_back(step);
  }
  CHECK(std::vector<std::uint64_t>(askers.begin(), askers.begin() + 5) ==
        std::vector<std::uint64_t>{1, 2, 3, 1, 2});
  CHECK(of_two == std::vector<std::uint64_t>{7, 8});
  CHECK(of_one == 100);
}

TEST_CASE(
    "who has used less of the session's time is next, and who comes does not wait for what others used") {
  CommandQueue queue;
  const auto took = [&](int milliseconds) { queue.spent(std::chrono::milliseconds(milliseconds)); };
  for (std::size_t i = 0; i < 60; ++i) REQUIRE(queue.offer({by(1), session::Step{i}}));
  CHECK(asker_of_next(queue) == 1);
  for (std::size_t i = 0; i < 5; ++i) REQUIRE(queue.offer({by(2), session::Step{i}}));  // meanwhile
  took(1000);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(asker_of_next(queue) == 2);
    took(10);
  }
  CHECK(asker_of_next(queue) == 1);
  REQUIRE(queue.offer({by(3), session::Play{}}));
  took(1000);
  CHECK(asker_of_next(queue) == 3);
  CHECK(asker_of_next(queue) == 1);
}

TEST_CASE("what a client that has left still asks for is dropped, but not what lets go of the cloth") {
  CommandQueue queue;
  for (std::size_t i = 0; i < 60; ++i) REQUIRE(queue.offer({by(1), session::Step{i}}));
  REQUIRE(queue.offer({by(1), session::ReachScene{7}}));
  REQUIRE(queue.offer({by(2), session::Step{8}}));
  queue.post({by(1), GrabEnd{}});
  CHECK(queue.drop(1).size() == 60);
  CHECK(queue.drop(3).empty());
  CHECK(std::get<session::ReachScene>(queue.pop().what).job == 7);
  CHECK(std::get<session::Step>(queue.pop().what).steps == 8);
  CHECK(std::holds_alternative<GrabEnd>(queue.pop().what));
  CHECK(queue.empty());
}

TEST_CASE("of viewers' wishes and their number only the newest waits, and a wish for a fresh frame stays") {
  CommandQueue queue;
  queue.post({{}, demand(30, true)});
  queue.post({{}, session::Watchers{1}});
  queue.post({{}, session::Hold{5}});
  queue.post({{}, demand(60, false)});
  queue.post({{}, session::Watchers{2}});
  const session::Command first = queue.pop();
  CHECK(std::get<session::Demand>(first.what).rate[0] == 60);
  CHECK(std::get<session::Demand>(first.what).fresh[0]);
  CHECK_FALSE(std::get<session::Demand>(first.what).fresh[1]);
  CHECK(std::get<session::Watchers>(queue.pop().what).count == 2);
  CHECK(std::get<session::Hold>(queue.pop().what).job == 5);
  CHECK(queue.empty());
}

TEST_CASE("of a hand's moves that wait only the newest counts, and none is moved before another command") {
  CommandQueue queue;
  const auto move = [&](int hand, double x) {
    return queue.offer({{1, std::nullopt}, GrabMove{hand, {x, 0.0, 0.0}}});
  };
  for (int i = 0; i < 5000; ++i) REQUIRE(move(i % 2, i));  // more than may wait
  REQUIRE(queue.offer({{1, std::nullopt}, GrabEnd{0}}));
  REQUIRE(move(0, -1.0));
  for (const auto& [hand, x] : {std::pair{0, 4998.0}, {1, 4999.0}}) {
    const Command command = queue.pop();
    CHECK(std::get<GrabMove>(command.what).hand == hand);
    CHECK(std::get<GrabMove>(command.what).target.x == x);
  }
  CHECK(std::holds_alternative<GrabEnd>(queue.pop().what));
  CHECK(std::get<GrabMove>(queue.pop().what).target.x == -1.0);
  CHECK(queue.empty());
}
