// A change of the scene that is given up while it is built leaves everything as it was, wherever in the work
// that happens.
#include <thread>

#include "server/base/pieces.h"
#include "server/session/stepper.h"
#include "server/sim/simulation.h"
#include "tests/catch.h"
#include "tests/scenes.h"

using namespace clothlab;
using session::Clock;
using session::json;

namespace {

constexpr session::Direction back = session::Direction::undo, forth = session::Direction::redo;

struct Watched {
  session::Exchange exchange{[] {}};
  std::unique_ptr<session::Stepper> stepper;
  int asked = 0;
  int pieces = 0;          ///< of the change under way, so far
  int given_up_after = 0;  ///< so many pieces; 0: never
  PieceWatch watch{[this] {
    if (!may_give_up() || ++pieces != given_up_after) return stepper ? stepper->look_up() : void();
    REQUIRE(exchange.offer({{2, 0}, session::TravelHistory{back, {}}}));
    std::this_thread::sleep_for(std::chrono::milliseconds(25));  // a look is taken every 20 ms
    stepper->look_up();
  }};

  Watched() {
    session::Limits limits;
    limits.kept_building = std::chrono::milliseconds(0);
    Result<scene::Document> document = scene::load_preset("seed");
    REQUIRE(document);
    auto made = session::Stepper::create(std::move(*document), exchange, limits);
    REQUIRE(made);
    stepper = std::move(*made);
  }

  /// The answer to a command of client 1, and that to the undo of client 2, if it was asked for.
  struct Answers {
    json of_change, of_undo;
  };
  Answers ask(decltype(session::Command::what) what) {
    REQUIRE(exchange.offer({{1, ++asked}, std::move(what)}));
    Answers answers;
    pieces = 0;
    const bool waits_for_undo = given_up_after > 0;
    while (answers.of_change.is_null() ||
           (waits_for_undo && pieces >= given_up_after && answers.of_undo.is_null())) {
      stepper->turn();
      std::vector<session::Event> events;
      exchange.take_events(events);
      for (const session::Event& event : events) {
        const auto* reply = std::get_if<session::Reply>(&event);
        if (!reply) continue;
        const auto* refusal = std::get_if<session::Refusal>(&reply->answer);
        json& answer = reply->ticket.asker == 1 ? answers.of_change : answers.of_undo;
        answer = refusal ? json{{"given_up", refusal->reason == session::Refusal::Reason::given_up},
                                {"refused", refusal->error.text()}}
                         : json::parse(*std::get<session::JsonText>(reply->answer));
      }
    }
    return answers;
  }

  struct Kept {
    json document;
    std::uint64_t revision, step, hash;
    bool operator==(const Kept&) const = default;
  };
  Kept kept() const {
    const session::Saved saved = stepper->saved();
    return {saved.document, saved.revision, saved.step, sim::state_hash(saved.state)};
  }
};

session::PatchScene patch(json content) {
  return {std::move(content), {}, {}, false};
}

}  // namespace

TEST_CASE("a change that is undone while it is built is as if it had not been asked for, at whatever piece") {
  Watched session;
  session.ask(session::Pause{});
  session.ask(session::Step{5});
  session.ask(patch({{"name", "a change to go back over"}}));
  const json grid{{"grid", {{"columns", 80}, {"rows", 80}, {"width", 1.0}, {"height", 1.0}}}};
  const std::vector<std::pair<const char*, json>> changes{
      {"numbers", {{"air_drag", 0.3}}},
      {"kernels", {{"solver", {{"method", "xpbd"}}}}},
      {"contact", {{"self_collision", {{"kind", "surface"}, {"thickness", 0.002}}}}},
      {"cloth, on the other engine",
       json::array({{{"op", "replace"}, {"path", "/cloths/0/mesh"}, {"value", grid}}})},
  };
  for (const auto& [what, change] : changes) {
    INFO(what);
    const Watched::Kept before = session.kept();
    int given_up = 0;
    for (int after = 1;; after = 1 + 2 * after) {
      INFO("given up after piece " << after);
      session.given_up_after = after;
      const Watched::Answers answers = session.ask(patch(change));
      session.given_up_after = 0;
      if (!answers.of_change.contains("refused")) {  // it has fewer pieces
        const json undone = session.ask(session::TravelHistory{back, {}}).of_change;
        REQUIRE(undone.contains("revision"));
        if (undone["applies"] != "cloth") CHECK(session.kept().hash == before.hash);
        break;
      }
      ++given_up;
      CHECK(answers.of_change["given_up"] == true);
      CHECK(answers.of_undo["applies"] == "none");
      CHECK(answers.of_undo["revision"] == before.revision);
      CHECK(session.kept() == before);
    }
    CHECK(given_up > 0);
  }
  // It computes what a session computes that was never asked for anything of that.
  session.ask(session::Reset{});
  session.ask(session::Step{45});
  Watched untouched;
  untouched.ask(session::Pause{});
  untouched.ask(session::Step{45});
  CHECK(session.kept().hash == untouched.kept().hash);
}

TEST_CASE(
    "redo is given up for an undo, which then has nothing else to do; the redo can be asked for again") {
  Watched session;
  session.ask(session::Pause{});
  session.ask(patch({{"solver", {{"method", "xpbd"}}}}));
  session.ask(session::TravelHistory{back, {}});
  session.ask(session::Step{1});  // else the kernels are still there
  const Watched::Kept before = session.kept();
  session.given_up_after = 1;
  const Watched::Answers answers = session.ask(session::TravelHistory{forth, {}});
  session.given_up_after = 0;
  CHECK(answers.of_change["given_up"] == true);
  CHECK(answers.of_undo["applies"] == "none");
  CHECK(session.kept() == before);
  CHECK(session.ask(session::TravelHistory{forth, {}}).of_change["applies"] == "kernel");
}
