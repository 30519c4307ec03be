// The changes of a scene that can be undone: what is one change, what they are called, what is forgotten.
#include "server/session/history.h"

#include "server/scene/document.h"
#include "server/session/change_name.h"
#include "tests/catch.h"

using namespace clothlab;
using session::Direction;
using session::History;
using std::chrono::milliseconds;

namespace {

struct Scene {
  History history;
  nlohmann::json present = scene::load_preset("seed")->value;
  History::Clock::time_point now{};

  void change(const char* pointer, nlohmann::json value, std::uint64_t by = 1, std::string name = "") {
    nlohmann::json after = present;
    after[nlohmann::json::json_pointer(pointer)] = std::move(value);
    history.add(history.prepare(present, after, std::move(name), by, now));
    present = std::move(after);
  }
  void travel(Direction direction) {
    REQUIRE(history.next(direction));
    present = *history.target(direction, present);
    history.moved(direction, 1);
  }
};

}  // namespace

TEST_CASE("values that one client changes in one place are one change while they come within a second") {
  Scene scene;
  const nlohmann::json first = scene.present;
  for (int i = 0; i < 5; ++i) {
    scene.change("/gravity/1", -1.0 - i);
    scene.now += milliseconds(1000);
  }
  CHECK(scene.history.told()["undos"] == 1);
  scene.now += milliseconds(1);
  scene.change("/gravity/1", -20.0);
  CHECK(scene.history.told()["undos"] == 2);
  scene.change("/gravity/1", -21.0, 2);
  CHECK(scene.history.told()["undos"] == 3);
  scene.change("/gravity/1", -22.0, 2, "moon");
  CHECK(scene.history.told()["undos"] == 4);
  scene.change("/wind", {{"velocity", {1, 0, 0}}}, 2, "moon");
  scene.change("/wind", nullptr, 2, "moon");
  CHECK(scene.history.told()["undos"] == 6);
  for (int i = 0; i < 6; ++i) scene.travel(Direction::undo);
  CHECK(scene.present == first);
}

TEST_CASE("what an undo leads to is not changed by a change that follows at once") {
  Scene scene;
  scene.change("/gravity/1", -1.0);
  scene.change("/air_drag", 1.0);
  scene.travel(Direction::undo);
  scene.change("/gravity/1", -2.0);  // the same place as the change that is now the last
  CHECK(scene.history.told()["undos"] == 2);
  scene.travel(Direction::undo);
  CHECK(scene.present["gravity"][1] == -1.0);
}

TEST_CASE(
    "changes are forgotten, the oldest first, beyond their bytes, and one that is too large is not kept") {
  Scene scene;
  const auto text = [](std::size_t bytes, char of) { return std::string(bytes, of); };
  const std::size_t third = session::max_change_bytes / 3;
  scene.change("/note", text(third / 2, 'a'));
  for (const char of : {'b', 'c', 'd', 'e', 'f'}) scene.change("/note", text(third / 2, of));
  const auto undos = scene.history.told()["undos"].get<std::size_t>();
  CHECK(undos >= 2);
  CHECK(undos < 6);
  CHECK(scene.history.next(Direction::undo)->forth.find('f') != std::string::npos);
  scene.change("/note", text(session::max_change_bytes, 'g'));
  CHECK(scene.history.told()["undos"] == 0);
  CHECK(scene.history.told()["undo"].is_null());
}

TEST_CASE("a name is at most 80 bytes long, and cut between characters") {
  for (std::size_t length = 60; length < 90; ++length) {
    std::string name(length, 'x');
    for (int i = 0; i < 10; ++i) name += "é";
    const std::string cut = session::change_name({name, "a", "b"});
    CHECK(cut.size() <= session::max_change_name_bytes);
    CHECK_NOTHROW(nlohmann::json(cut).dump());
    CHECK(cut.ends_with("… and 2 more"));
  }
}
