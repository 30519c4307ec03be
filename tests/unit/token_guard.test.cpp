// A client that guesses tokens is refused for a while, and forgotten afterwards.
#include "server/net/token_guard.h"

#include "tests/catch.h"

using namespace clothlab;
using net::TokenGuard;

namespace {
constexpr std::int64_t second = 1'000'000;

void guess(TokenGuard& guard, const std::string& address, int times, std::int64_t now) {
  for (int i = 0; i < times; ++i) {
    REQUIRE(guard.wait(address, now) == 0);
    guard.was_wrong(address, now);
  }
}
}  // namespace

TEST_CASE("after its wrong tokens an address waits for as long as the next one takes to be due") {
  TokenGuard guard(10);  // one guess every 6 s
  guess(guard, "a", 10, 0);
  CHECK(guard.wait("a", 0) == 6);
  CHECK(guard.wait("a", 1) == 6);  // rounded up: a client that waits that long is not refused again
  CHECK(guard.wait("a", 5 * second + 1) == 1);
  CHECK(guard.wait("a", 6 * second - 10) == 1);
  CHECK(guard.wait("a", 6 * second + 10) == 0);
  guess(guard, "a", 1, 6 * second + 10);
  CHECK(guard.wait("a", 6 * second + 10) == 6);
}

TEST_CASE("in an hour of guessing as fast as it may an address is heard N times a minute, and N at first") {
  TokenGuard guard(7);
  int heard = 0;
  for (std::int64_t now = 0; now < 3600 * second; now += second / 10) {
    if (guard.wait("a", now) > 0) continue;
    guard.was_wrong("a", now);
    ++heard;
  }
  CHECK(heard <= 7 + 60 * 7);
  CHECK(heard >= 60 * 7);
}

TEST_CASE("wrong tokens of one address do not count for another") {
  TokenGuard guard(1);
  guess(guard, "a", 1, 0);
  CHECK(guard.wait("a", 0) == 60);
  CHECK(guard.wait("b", 0) == 0);
}

TEST_CASE("an address that may send all its wrong tokens at once again is forgotten, and not before") {
  TokenGuard guard(2);  // one guess every 30 s
  for (int i = 0; i < 1000; ++i) guess(guard, std::to_string(i), 1, 0);
  guess(guard, "a", 2, 0);
  CHECK(guard.count() == 1001);
  guess(guard, "b", 1, 31 * second);
  CHECK(guard.count() == 2);  // one guess of "a" has expired
  guess(guard, "a", 1, 32 * second);
  CHECK(guard.wait("a", 32 * second) > 0);
  guess(guard, "c", 1, 200 * second);
  CHECK(guard.count() == 1);
  guess(guard, "a", 2, 200 * second);
}
