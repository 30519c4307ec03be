#include "server/session/exchange.h"

#include <thread>

#include "tests/catch.h"

using namespace clothlab;
using session::Clock;
using session::Exchange;

namespace {
stream::SharedMessage frame(stream::Encoding encoding, std::uint32_t sequence) {
  auto message = std::make_shared<stream::Message>();
  message->header.encoding = encoding;
  message->header.sequence = sequence;
  return message;
}
}  // namespace

TEST_CASE("commands that wait come one after another, and none is lost") {
  Exchange exchange([] {});
  for (std::size_t i = 0; i < 20; ++i) REQUIRE(exchange.offer({{}, session::Step{i}}));
  exchange.post({{}, session::Watchers{3}});
  std::size_t steps = 0, taken = 0;
  REQUIRE(exchange.wait_for_command(Clock::now()));
  for (; const std::optional<session::Command> command = exchange.next_command(); ++taken)
    if (const auto* step = std::get_if<session::Step>(&command->what)) CHECK(step->steps == steps++);
  CHECK(taken == 21);
  CHECK(steps == 20);
}

TEST_CASE(
    "a change is given up for an undo or another scene, and for nothing that the same client sent before") {
  using Why = Exchange::GiveUp::Why;
  const session::Ticket one{1, 1}, other{2, 5};
  const session::TravelHistory undo{session::Direction::undo, {}}, redo{session::Direction::redo, {}};
  const auto why = [](const std::vector<session::Command>& waiting, bool an_undo = false) {
    Exchange exchange([] {});
    for (const session::Command& command : waiting) REQUIRE(exchange.offer(command));
    const std::optional<Exchange::GiveUp> wish = exchange.to_give_up(1, an_undo);
    return wish ? std::optional(wish->why) : std::nullopt;
  };
  CHECK_FALSE(why({}));
  CHECK_FALSE(why({{one, session::PatchScene{}}, {other, session::PatchScene{}}, {other, session::Play{}}}));
  CHECK(why({{one, session::GetScene{}}, {one, undo}}) == Why::undone);
  CHECK(why({{other, undo}}) == Why::undone);
  CHECK_FALSE(why({{one, undo}}, true));  // two undos are two steps back
  CHECK_FALSE(why({{one, redo}}));
  CHECK_FALSE(why({{one, session::PatchScene{}}, {one, undo}}));  // of the second patch
  CHECK(why({{one, session::LoadScene{}}}) == Why::loaded);
  CHECK(why({{one, session::LoadScene{}}}, true) == Why::loaded);
  Exchange ends([] {});
  ends.stop();
  CHECK(ends.to_give_up(1, true)->why == Why::stopping);
}

TEST_CASE(
    "a second after a client has left, what it asked for is forgotten, and what others asked for is not") {
  Exchange exchange([] {});
  REQUIRE(exchange.offer({{1, 1}, session::PatchScene{}}));
  REQUIRE(exchange.offer({{1, 2}, session::PatchScene{}}));
  REQUIRE(exchange.offer({{2, 1}, session::Play{}}));
  exchange.leave(1);
  CHECK(exchange.next_command()->ticket.asker == 1);  // it has just been sent
  CHECK_FALSE(exchange.to_give_up(1, false));
  std::this_thread::sleep_for(Exchange::leave_time);
  CHECK(exchange.to_give_up(1, false)->why == Exchange::GiveUp::Why::left);
  CHECK_FALSE(exchange.to_give_up(2, false));
  CHECK(exchange.next_command()->ticket.asker == 2);
  CHECK_FALSE(exchange.next_command());
  std::vector<session::Event> owed;
  exchange.give_up({"session", "it failed", "again"}, owed);
  CHECK(owed.size() == 2);  // to what was taken of 1, and of 2; not to what was dropped
}

TEST_CASE("the mailbox keeps the latest frame of each encoding, for every viewer the same bytes") {
  Exchange exchange([] {});
  CHECK_FALSE(exchange.frame(stream::Encoding::q16));
  exchange.publish(frame(stream::Encoding::q16, 1));
  exchange.publish(frame(stream::Encoding::f32, 2));
  exchange.publish(frame(stream::Encoding::q16, 3));
  CHECK(exchange.frame(stream::Encoding::q16)->header.sequence == 3);
  CHECK(exchange.frame(stream::Encoding::q16) == exchange.frame(stream::Encoding::q16));
  exchange.forget_frame(stream::Encoding::q16);
  CHECK_FALSE(exchange.frame(stream::Encoding::q16));
  CHECK(exchange.frame(stream::Encoding::f32)->header.sequence == 2);
}

TEST_CASE("events arrive once and in order, and each wakes the service thread") {
  int wakes = 0;
  Exchange exchange([&wakes] { ++wakes; });
  exchange.emit(session::Notice{"info", "first"});
  exchange.emit(session::Notice{"info", "second"});
  std::vector<session::Event> events;
  exchange.take_events(events);
  REQUIRE(events.size() == 2);
  CHECK(std::get<session::Notice>(events[0]).text == "first");
  CHECK(std::get<session::Notice>(events[1]).text == "second");
  CHECK(wakes == 2);
  exchange.take_events(events);
  CHECK(events.empty());
}

TEST_CASE("events of a batch arrive together at its end, and wake the service thread once") {
  int wakes = 0;
  Exchange exchange([&wakes] { ++wakes; });
  std::vector<session::Event> events;
  exchange.emit(session::Notice{"info", "before"});
  {
    const Exchange::Batch batch(exchange);
    exchange.emit(session::Notice{"info", "first"});
    exchange.publish(session::Status{});
    exchange.emit(session::Notice{"info", "second"});
    exchange.take_events(events);
    REQUIRE(events.size() == 1);
    CHECK(std::holds_alternative<session::Notice>(events[0]));
    exchange.take_events(events);
    CHECK(events.empty());
    CHECK(wakes == 1);
  }
  CHECK(wakes == 2);
  exchange.take_events(events);
  REQUIRE(events.size() == 3);
  CHECK(std::get<session::Notice>(events[0]).text == "first");
  CHECK(std::get<session::Notice>(events[2]).text == "second");
  { const Exchange::Batch empty(exchange); }
  CHECK(wakes == 2);
}

TEST_CASE("only the newest status waits, after the events before it and before those after it") {
  Exchange exchange([] {});
  const auto status = [](double speed) {
    session::Status status;
    status.speed = speed;
    return status;
  };
  exchange.publish(status(1));
  exchange.emit(session::Notice{"info", "between"});
  exchange.publish(status(2));
  exchange.emit(session::Notice{"info", "after"});
  std::vector<session::Event> events;
  exchange.take_events(events);
  REQUIRE(events.size() == 3);
  CHECK(std::get<session::Notice>(events[0]).text == "between");
  CHECK(std::get<session::Status>(events[1]).speed == 2);
  CHECK(std::get<session::Notice>(events[2]).text == "after");
  exchange.take_events(events);
  CHECK(events.empty());
}

TEST_CASE("a session that is told to stop does not wait for commands") {
  Exchange exchange([] {});
  exchange.stop();
  CHECK_FALSE(exchange.wait_for_command(Clock::now() + std::chrono::hours(1)));
}
