#include "server/session/exchange.h"

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

TEST_CASE("a turn takes a few of the commands that wait, and none is lost") {
  Exchange exchange([] {});
  for (std::size_t i = 0; i < 20; ++i) REQUIRE(exchange.offer({{}, session::Step{i}}));
  exchange.post({{}, session::Watchers{3}});
  std::vector<session::Command> commands;
  std::size_t steps = 0, taken = 0;
  while (taken < 21) {
    REQUIRE(exchange.take_commands(commands, Clock::now()));
    REQUIRE_FALSE(commands.empty());
    REQUIRE(commands.size() <= Exchange::commands_a_turn);
    for (const session::Command& command : commands)
      if (const auto* step = std::get_if<session::Step>(&command.what)) CHECK(step->steps == steps++);
    taken += commands.size();
  }
  CHECK(steps == 20);
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
  std::vector<session::Command> commands;
  CHECK_FALSE(exchange.take_commands(commands, Clock::now() + std::chrono::hours(1)));
}
