// The session's thread, run in this process: counts its allocations, and what they hold.
#include "server/session/stepper.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <thread>

#include "server/gl/context.h"
#include "tests/catch.h"

namespace {
thread_local std::size_t allocations = 0;  // by operator new; the GL driver uses other allocators
std::atomic<std::size_t> bytes_held = 0;   // [bytes], by operator new, of all threads

void* counted(void* memory) {
  bytes_held += malloc_usable_size(memory);
  return memory;
}
void* allocate(std::size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes)) return counted(memory);
  throw std::bad_alloc();
}
void give_back(void* memory) {
  bytes_held -= malloc_usable_size(memory);
  std::free(memory);
}
}  // namespace

void* operator new(std::size_t bytes) {
  return allocate(bytes);
}
void* operator new[](std::size_t bytes) {
  return allocate(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  ++allocations;
  return counted(std::malloc(bytes));
}
void* operator new[](std::size_t bytes, const std::nothrow_t& tag) noexcept {
  return operator new(bytes, tag);
}
void operator delete(void* memory) noexcept {
  give_back(memory);
}
void operator delete[](void* memory) noexcept {
  give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  give_back(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  give_back(memory);
}

using namespace clothlab;
using session::Clock;

namespace {

struct Fixture {
  session::Exchange exchange{[] {}};
  std::unique_ptr<session::Stepper> stepper;
  std::vector<session::Command> commands;
  int asked = 0;

  explicit Fixture(const session::Limits& limits = {},
                   Result<scene::Document> document = scene::load_preset("seed")) {
    REQUIRE(document);
    Result<std::unique_ptr<session::Stepper>> created =
        session::Stepper::create(std::move(*document), exchange, limits);
    REQUIRE(created);
    stepper = std::move(*created);
  }

  /// What the session answers to a command, when it does.
  nlohmann::json ask(decltype(session::Command::what) what) {
    commands.push_back({{1, ++asked}, std::move(what)});
    while (true) {
      turn();
      std::vector<session::Event> events;
      exchange.take_events(events);
      for (session::Event& event : events) {
        const auto* reply = std::get_if<session::Reply>(&event);
        if (!reply || reply->ticket.id != asked) continue;
        if (const auto* refusal = std::get_if<session::Refusal>(&reply->answer))
          return {{"refused", refusal->error.text()}};
        return nlohmann::json::parse(*std::get<session::JsonText>(reply->answer));
      }
    }
  }

  void turn() {
    for (session::Command& command : commands) exchange.post(std::move(command));
    const Clock::time_point next = stepper->turn();
    commands.clear();
    std::this_thread::sleep_until(std::min(next, Clock::now() + std::chrono::milliseconds(20)));
  }
  void turn_for(double seconds) {
    for (const auto until = Clock::now() + std::chrono::duration<double>(seconds); Clock::now() < until;)
      turn();
  }

  /// Turns the stepper until `frames` more frames were published; returns the number of allocations.
  std::size_t allocations_for(std::uint32_t frames) {
    const auto sequence = [&] {
      const stream::SharedMessage frame = exchange.frame(stream::Encoding::q16);
      return frame ? frame->header.sequence : 0u;
    };
    const std::uint32_t until = sequence() + frames;
    const std::size_t before = allocations;
    while (sequence() < until) turn();
    return allocations - before;
  }
};

}  // namespace

TEST_CASE("in steady state the stepping thread allocates nothing but the frames themselves") {
  Fixture session;
  session::Demand demand;
  demand.rate[static_cast<std::size_t>(stream::Encoding::q16)] = 60;
  session.commands.push_back({{}, session::Watchers{1}});
  session.commands.push_back({{}, demand});
  session.allocations_for(40);
  constexpr std::size_t frames = 120, a_frame = 2;  // the message with its reference count, and its bytes
  // The longest stable step is searched for beside the session, and is taken over once, which allocates. On a
  // busy machine it can be found in any of these windows, but not in more than one.
  std::size_t counted = session.allocations_for(frames);
  if (counted > frames * a_frame) counted = std::min(counted, session.allocations_for(frames));
  CHECK(counted >= frames);  // the counter works
  // A slow machine gets one notice that it is slow, which needs some allocations, too; and of each second a
  // state is kept, with its buffers.
  constexpr std::size_t a_notice = 16, kept_states = 4, a_kept_state = 48;
  CHECK(counted <= frames * a_frame + a_notice + kept_states * a_kept_state);
}

TEST_CASE("an unwatched session steps until --unwatched-timeout, sleeps, and goes on when somebody comes") {
  session::Limits limits;
  limits.unwatched_seconds = 1;
  Fixture session(limits);
  session.turn_for(0.2);
  const std::uint64_t early = session.exchange.steps();
  CHECK(early > 0);
  session.turn_for(2.0);
  const std::uint64_t asleep = session.exchange.steps();
  CHECK(asleep > early);
  session.turn_for(0.5);
  CHECK(session.exchange.steps() == asleep);
  session.commands.push_back({{}, session::Watchers{1}});
  session.turn_for(1.0);
  CHECK(session.exchange.steps() > asleep);
}

namespace {

/// A document of some hundred kilobytes: it has its cloth's vertices and triangles, 70 in a row.
scene::Document large_document() {
  nlohmann::json vertices, triangles;
  constexpr int side = 70;
  for (int i = 0; i < side * side; ++i) {
    vertices.push_back({0.0125 * (i % side), 1.0, 0.0125 * (i / side)});
    if (i % side == 0 || i < side) continue;
    triangles.push_back({i - side - 1, i - 1, i});
    triangles.push_back({i - side - 1, i, i - side});
  }
  return *scene::validate(
      {{"version", 1}, {"cloths", {{{"mesh", {{"vertices", vertices}, {"triangles", triangles}}}}}}});
}

}  // namespace

TEST_CASE("what a paused session keeps of its past is bounded, however large its document is") {
  Fixture session({}, large_document());
  session.ask(session::Pause{});
  const std::size_t before = bytes_held;
  for (int i = 0; i < 80; ++i) {
    const nlohmann::json changed = session.ask(session::PatchScene{{{"air_drag", 0.01 * i}}, {}, {}});
    REQUIRE(changed.contains("revision"));
  }
  constexpr std::size_t promised = (48 + 16) << 20,
                        present = 24 << 20;  // with copies of the present document
  CHECK(bytes_held < before + promised + present);
  const nlohmann::json told = session.ask(session::GetTimeline{});
  CHECK((told.contains("refused") || told["bytes"] < 48 << 20));
  session.ask(session::Step{1});
  CHECK(session.ask(session::GetTimeline{})["newest"]["step"] > 0);
}

TEST_CASE("contacts are read once for each state, however many of them who asks wants") {
  Fixture session;
  session.ask(session::Pause{});
  session.ask(session::Step{20});
  const nlohmann::json first = session.ask(session::InspectContacts{1});
  CHECK(first["step"] == 20);
  // To read them takes a list of neighbours for each of 625 vertices.
  for (const std::size_t most : {1000u, 3u}) {
    const std::size_t before = allocations;
    CHECK(session.ask(session::InspectContacts{most})["total"] == first["total"]);
    CHECK(allocations - before < 500);
  }
  session.ask(session::Step{1});
  CHECK(session.ask(session::InspectContacts{3})["step"] == 21);
}
