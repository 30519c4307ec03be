#include "server/net/pacing.h"

#include <optional>

#include "tests/catch.h"

using namespace clothlab;
using net::FramePacing;

namespace {
constexpr std::int64_t second = 1'000'000;

FramePacing subscribed(double rate, int in_flight) {
  FramePacing pacing;
  pacing.subscribe(stream::Encoding::q16, rate, in_flight, 0);
  return pacing;
}
bool may_go(const FramePacing& pacing, std::int64_t now) {
  return pacing.wait(now) == std::optional<std::int64_t>(0);
}
}  // namespace

TEST_CASE("a viewer that has not subscribed gets no frame") {
  const FramePacing pacing;
  CHECK_FALSE(pacing.wait(0).has_value());
}

TEST_CASE("no more than in_flight frames are unacknowledged, and an acknowledgement takes all before it") {
  FramePacing pacing = subscribed(60, 3);
  std::int64_t now = 0;
  for (std::uint32_t sequence = 1; sequence <= 3; ++sequence, now += second) {
    REQUIRE(may_go(pacing, now));
    pacing.sent(sequence, now);
  }
  CHECK_FALSE(pacing.wait(now).has_value());
  pacing.acknowledge(2, now);
  CHECK(pacing.unacknowledged() == 1);
  CHECK(may_go(pacing, now));
}

TEST_CASE("acknowledging a frame that was never sent changes nothing") {
  FramePacing pacing = subscribed(60, 1);
  pacing.acknowledge(7, 0);
  pacing.sent(10, 0);
  pacing.acknowledge(11, second);
  CHECK_FALSE(pacing.wait(second).has_value());
}

TEST_CASE("frames that come at the viewer's rate with jitter all go through") {
  FramePacing pacing = subscribed(60, 8);
  int sent = 0;
  for (std::uint32_t frame = 0; frame < 600; ++frame) {
    const std::int64_t jitter = frame % 2 == 0 ? 1500 : -1500;
    const std::int64_t now = frame * second / 60 + jitter;
    if (!may_go(pacing, now)) continue;
    pacing.sent(frame, now);
    pacing.acknowledge(frame, now);
    ++sent;
  }
  CHECK(sent == 600);
}

TEST_CASE("a viewer of 20 frames/s among frames at 120 gets 20, not more") {
  FramePacing pacing = subscribed(20, 8);
  int sent = 0;
  for (std::uint32_t frame = 0; frame < 1200; ++frame) {
    const std::int64_t now = frame * second / 120;
    if (!may_go(pacing, now)) continue;
    pacing.sent(frame, now);
    pacing.acknowledge(frame, now);
    ++sent;
  }
  CHECK(sent >= 199);
  CHECK(sent <= 201);  // 10 s at 20 per second, and the first at once
}

TEST_CASE("after a stall one frame is caught up, no more") {
  FramePacing pacing = subscribed(50, 8);
  const std::int64_t late = 10 * second;
  for (const std::uint32_t sequence : {1u, 2u}) {
    REQUIRE(may_go(pacing, late));
    pacing.sent(sequence, late);
    pacing.acknowledge(sequence, late);
  }
  CHECK_FALSE(may_go(pacing, late + 1'000));
  CHECK(may_go(pacing, late + 20'000));
}

TEST_CASE("sequence numbers may wrap around") {
  FramePacing pacing = subscribed(60, 2);
  pacing.sent(0xFFFFFFFFu, 0);
  CHECK(pacing.is_news(3));
  CHECK_FALSE(pacing.is_news(0xFFFFFFFEu));
  pacing.sent(3, second);
  CHECK_FALSE(pacing.wait(2 * second).has_value());
  pacing.acknowledge(3, 2 * second);
  CHECK(pacing.unacknowledged() == 0);
}

TEST_CASE("a change of encoding makes the present frame news") {
  FramePacing pacing = subscribed(60, 2);
  pacing.sent(9, 0);
  CHECK_FALSE(pacing.is_news(9));
  pacing.subscribe(stream::Encoding::f32, 60, 2, second);
  CHECK(pacing.is_news(9));
}

TEST_CASE("a change of field makes the present frame news, older though it may be") {
  FramePacing pacing = subscribed(60, 2);
  pacing.sent(9, 0);
  pacing.subscribe({stream::Encoding::q16, stream::Field::speed}, 60, 2, second);
  CHECK(pacing.is_news(8));
  pacing.sent(8, second);
  CHECK_FALSE(pacing.is_news(8));
}

TEST_CASE("frames under way when the form changes still count, and can still be acknowledged") {
  FramePacing pacing = subscribed(60, 2);
  pacing.sent(9, 0);
  pacing.sent(10, 0);
  pacing.subscribe({stream::Encoding::q16, stream::Field::speed}, 60, 2, second);
  CHECK_FALSE(pacing.wait(second).has_value());
  pacing.acknowledge(9, second);
  REQUIRE(pacing.wait(second) == 0);
  pacing.sent(8, second);  // the newest of the other form
  CHECK(pacing.unacknowledged() == 2);
  pacing.acknowledge(10, second);  // of the form before
  CHECK(pacing.unacknowledged() == 0);
}

TEST_CASE("time that the viewer held frames back does not count as the server's") {
  FramePacing pacing = subscribed(100, 1);
  pacing.sent(1, 0);
  pacing.acknowledge(1, 3 * second);
  CHECK(pacing.ready_since(4 * second) == 3 * second);
}

TEST_CASE("a bucket lets its burst through, then its rate") {
  net::TokenBucket bucket(10, 5, 0);
  for (int i = 0; i < 5; ++i) CHECK(bucket.take(0));
  CHECK_FALSE(bucket.take(0));
  CHECK(bucket.take(second / 10 + 1));
  CHECK_FALSE(bucket.take(second / 10 + 1));
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += bucket.take(100 * second) ? 1 : 0;
  CHECK(taken == 5);
}

TEST_CASE("a message that costs more than a bucket holds passes, and is paid off before the next one") {
  net::TokenBucket bucket(10, 5, 0);
  CHECK(bucket.take(0, 25));  // 20 short: two seconds, and a tenth for the next
  CHECK_FALSE(bucket.take(2 * second));
  CHECK(bucket.take(2 * second + second / 10 + 1));
}
