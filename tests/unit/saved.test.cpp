// The bytes from which a session is restored.
#include "server/session/saved.h"

#include "server/scene/document.h"
#include "server/session/keeper.h"
#include "tests/catch.h"

using namespace clothlab;

namespace {

session::Saved some() {
  session::Saved saved;
  saved.document = scene::load_preset("seed")->value;
  saved.revision = 7;
  saved.playing = false;
  saved.speed = 0.25;
  saved.time = 1.0 / 3.0;
  saved.step = 1234567890123;
  for (int i = 0; i < 5; ++i) {
    saved.state.position.emplace_back(0.1f * static_cast<float>(i), -1e-30f, 3.0f);
    saved.state.velocity.emplace_back(-1.0f, 1e20f, static_cast<float>(i));
  }
  return saved;
}

}  // namespace

TEST_CASE("a saved session is read back as it was, to the last bit") {
  const session::Saved before = some();
  const Result<session::Saved> after = session::saved_from(session::to_bytes(before));
  REQUIRE(after);
  CHECK(after->document == before.document);
  CHECK(after->revision == before.revision);
  CHECK(after->playing == before.playing);
  CHECK(after->speed == before.speed);
  CHECK(after->time == before.time);
  CHECK(after->step == before.step);
  CHECK(after->state.position == before.state.position);
  CHECK(after->state.velocity == before.state.velocity);
}

TEST_CASE(
    "a saved session of any other length is refused, and so is one with a changed bit among its floats") {
  const std::string bytes = session::to_bytes(some());
  for (std::size_t length = 0; length < bytes.size(); ++length)
    if (session::saved_from(bytes.substr(0, length))) FAIL("taken with " << length << " bytes");
  CHECK_FALSE(session::saved_from(bytes + '\0'));
  for (std::size_t at = bytes.size() - 2 * 5 * sizeof(glm::vec3); at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = bytes;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << bit));
      if (session::saved_from(flipped)) FAIL("taken with bit " << bit << " of byte " << at << " changed");
    }
}

TEST_CASE("what a save waits for the processors puts off none; its work does, to a tenth of the time") {
  using session::Keeper;
  using namespace std::chrono_literals;
  const Keeper::Clock::time_point begun{1h};
  const auto next = [&](auto took, auto worked) {
    return Keeper::next_save(begun, begun + took, worked) - begun;
  };
  CHECK(next(1ms, 1ms) == Keeper::period);
  CHECK(next(220ms, 20ms) == Keeper::period);  // others had the processors for 0.2 s
  CHECK(Keeper::period <= 500ms);              // a turn and a save may take as long until a second is lost
  CHECK(next(100ms, 100ms) == 1s);
  CHECK(next(2s, 10ms) == 4s);  // a slow disk has half of the time
}
