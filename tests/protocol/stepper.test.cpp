// The session's thread, run in this process: counts its allocations.
#include "server/session/stepper.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <thread>

#include "server/gl/context.h"
#include "tests/catch.h"

namespace {
thread_local std::size_t allocations = 0;  // by operator new; the GL driver uses other allocators

void* allocate(std::size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
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
  return std::malloc(bytes);
}
void* operator new[](std::size_t bytes, const std::nothrow_t& tag) noexcept {
  return operator new(bytes, tag);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}

using namespace clothlab;
using session::Clock;

namespace {

struct Fixture {
  session::Exchange exchange{[] {}};
  std::unique_ptr<session::Stepper> stepper;
  std::vector<session::Command> commands;

  explicit Fixture(const session::Limits& limits = {}) {
    Result<scene::Document> seed = scene::load_preset("seed");
    REQUIRE(seed);
    Result<std::unique_ptr<session::Stepper>> created =
        session::Stepper::create(std::move(*seed), exchange, limits);
    REQUIRE(created);
    stepper = std::move(*created);
  }

  void turn() {
    const Clock::time_point next = stepper->turn(commands);
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
