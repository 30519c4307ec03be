// Messages to a client are sent in order, and a status is dropped if there is a newer one.
#include "server/net/outbox.h"

#include "server/net/limits.h"
#include "tests/catch.h"

using namespace clothlab;
using net::make_text;
using net::Outbox;

namespace {

std::string next(Outbox& outbox) {
  const net::SharedText text = outbox.pop();
  return text ? std::string(reinterpret_cast<const char*>(text->data()), text->size()) : "";
}

}  // namespace

TEST_CASE("a status takes the place of the one that waits, behind what was said since") {
  Outbox outbox;
  CHECK(outbox.empty());
  REQUIRE(outbox.push(make_text("first")));
  REQUIRE(outbox.push_status(make_text("old status")));
  REQUIRE(outbox.push(make_text("second")));
  REQUIRE(outbox.push_status(make_text("status")));
  REQUIRE(outbox.push(make_text("third")));
  outbox.push_first(make_text("hello"));
  for (const char* text : {"hello", "first", "second", "status", "third"}) CHECK(next(outbox) == text);
  CHECK(outbox.empty());
  // A status that has been sent is not searched for.
  REQUIRE(outbox.push_status(make_text("a status again")));
  CHECK(next(outbox) == "a status again");
  CHECK(next(outbox).empty());
}

TEST_CASE("statuses never pile up, what must not be lost does: up to max_unsent_text_bytes") {
  Outbox outbox;
  for (int i = 0; i < 100; ++i) REQUIRE(outbox.push_status(make_text(std::string(1000, ' '))));
  REQUIRE(outbox.push(make_text(std::string(net::max_unsent_text_bytes - 2000, ' '))));
  CHECK_FALSE(outbox.push(make_text(std::string(2000, ' '))));
}

TEST_CASE(
    "the newest document takes the place of those that wait, and of their changes: a slow reader loses "
    "none") {
  Outbox outbox;
  const std::string large(3 << 20, ' ');
  for (int i = 0; i < 5; ++i) {
    outbox.push_scene(make_text(large + std::to_string(i)));
    REQUIRE(outbox.push_change(make_text("a change")));
    REQUIRE(outbox.push(make_text("an answer")));
  }
  outbox.push_scene(make_text("the scene"));
  CHECK_FALSE(outbox.crowded());
  REQUIRE(outbox.push_change(make_text("its change")));
  for (int i = 0; i < 5; ++i) CHECK(next(outbox) == "an answer");
  CHECK(next(outbox) == "the scene");
  // What has been sent cannot be replaced.
  outbox.push_scene(make_text("the next"));
  CHECK(next(outbox) == "the next");
  CHECK(outbox.empty());
  outbox.push_scene(make_text(large));
  CHECK(outbox.crowded());
  REQUIRE(outbox.push(make_text(large)));
  CHECK_FALSE(outbox.push(make_text(large)));
}
