// A session computes what `run` computes, bit for bit, whoever watches it: it keeps states for its timeline,
// is diagnosed, recorded, watched, inspected, grabbed and let go, changed there and back, paused and played,
// and goes on from a step of its timeline. CLOTHLAB_THOROUGH in the environment tries every preset under
// every method, for longer.
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/gl/context.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/session/stepper.h"
#include "tests/scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

const bool thorough = test::thorough();
const int compared_every = thorough ? 100 : 10, kept_every = thorough ? 70 : 7;
constexpr int stretches = 4;

/// The kinds of self-collision under which a method is tried. CLOTHLAB_THOROUGH: both, under each method.
/// Else none under those whose steps hold little that another's do not, and each kind under two: surfaces
/// under VBD, which remembers most, and implicit Euler, whose problem they are a term of.
std::vector<std::string> kinds_under(Method method) {
  if (thorough) return {"points", "surface"};
  switch (method) {
    case Method::explicit_euler:
    case Method::rk4:
    case Method::verlet:
    case Method::pbd:
    case Method::bdf2:
      break;
    case Method::symplectic_euler:
    case Method::xpbd:
      return {"points"};
    case Method::implicit_euler:
    case Method::vbd:
      return {"surface"};
  }
  return {};
}

/// Small, and with all that passes remember: lists of neighbours or pairs, pulls of a strain limit, wind, a
/// pin that moves and a ball that the cloth lies on from the first step.
constexpr const char* busy_scene = R"({
  "version": 1, "name": "busy",
  "cloths": [{ "mesh": { "grid": { "columns": 12, "rows": 12, "width": 0.5, "height": 0.5 } },
               "transform": { "translate": [0, 1, 0], "rotate": [90, 0, 0] },
               "material": { "strain_limit": 0.02 },
               "pins": [{ "at": "corner:0,0",
                          "motion": { "oscillate": { "axis": [0, 0, 1], "amplitude": 0.1, "frequency": 5 } } }] }],
  "colliders": [{ "sphere": { "center": [0, 0.745, 0], "radius": 0.25 }, "friction": 0.3 }],
  "wind": { "velocity": [1, 0, 0] },
  "self_collision": { "kind": "KIND", "thickness": 0.02 }
})";

scene::Document busy(const std::string& kind) {
  std::string text = busy_scene;
  text.replace(text.find("KIND"), 4, kind);
  return test::document_of(text);
}

/// The document under a method, with steps that are stable.
scene::Document under(const scene::Document& document, Method method) {
  scene::json value = document.value;
  value["solver"]["method"] = scene::name(method);
  const auto validated = [&] {
    Result<scene::Document> made = scene::validate(value, document.assets);
    if (!made) FAIL(made.error().text());
    return *made;
  };
  const bool limited = !scene::iterates(method);
  if (limited) {
    const scene::Document tried = validated();
    value["solver"]["dt"] = 0.5 * model::dt_limit_bound(*model::build(tried.scene), tried.scene);
  } else if (document.scene.solver.method != method) {
    value["solver"]["dt"] = 0.004;
    value["solver"]["iterations"] = scene::solves(method) ? 1 : 4;
  }
  return validated();
}

/// The document with keys of all kinds that change in the first 30 steps, in which its pin lets go, too.
scene::Document keyed(const scene::Document& document) {
  const double dt = document.scene.solver.dt;
  scene::json value = document.value;
  const auto key = [&](const char* of, double from, double to, scene::json first, scene::json last) {
    value["keys"].push_back({{"of", of}, {"at", {{from * dt, first}, {to * dt, last}}}});
  };
  key("/gravity", 3, 25, {0, -9.8, 0}, {2, -5, 0});
  key("/air_drag", 0, 30, 0, 2);
  key("/wind/velocity", 5.5, 20, {1, 0, 0}, {0, 0, 3});
  key("/colliders/0/friction", 0, 30, 0.3, 0.8);
  key("/cloths/0/material/shear", 8, 18, 10000, 5000);
  key("/cloths/0/pins/0/held", 0, 16.5, true, false);
  Result<scene::Document> made = scene::validate(value, document.assets);
  if (!made) FAIL(made.error().text());
  return *made;
}

using Hashes = std::map<std::uint64_t, std::uint64_t>;  ///< [step]

/// What `run` computes: steps, and nothing else.
Hashes hashes_of_run(const scene::Scene& scene, int steps) {
  const auto context = test::context();
  const auto simulation = test::simulation(scene);
  Hashes hashes;
  for (int step = 0; step <= steps; ++step) {
    hashes[simulation->step_index()] = sim::state_hash(simulation->read_state());
    simulation->step(1);
  }
  return hashes;
}

struct Watched {
  session::Exchange exchange{[] {}};
  std::unique_ptr<session::Stepper> stepper;
  std::uint64_t asked = 0;
  bool diverged = false;

  explicit Watched(const scene::Document& document) {
    session::Limits limits;
    limits.kept_every = kept_every;
    Result<std::unique_ptr<session::Stepper>> created = session::Stepper::create(document, exchange, limits);
    if (!created) FAIL(created.error().text());
    stepper = std::move(*created);
  }

  void turn(std::vector<session::Command> commands = {}) {
    for (session::Command& command : commands) exchange.post(std::move(command));
    const session::Clock::time_point next = stepper->turn();
    std::this_thread::sleep_until(std::min(next, session::Clock::now() + std::chrono::milliseconds(10)));
  }

  /// Gives a command, and turns until it is answered.
  template <class Command>
  session::json ask(Command command) {
    session::Ticket ticket{1, session::json(++asked)};
    std::vector<session::Command> commands;
    commands.push_back({ticket, std::move(command)});
    for (turn(std::move(commands));; turn()) {
      std::vector<session::Event> events;
      exchange.take_events(events);
      std::optional<session::json> answer;
      for (const session::Event& event : events) {
        diverged = diverged || std::holds_alternative<session::Diverged>(event);
        const auto* reply = std::get_if<session::Reply>(&event);
        if (!reply || reply->ticket.id != ticket.id) continue;
        if (const auto* refusal = std::get_if<session::Refusal>(&reply->answer)) {
          if (!diverged) FAIL(refusal->error.text());
          return {};
        }
        answer = session::json::parse(*std::get<session::JsonText>(reply->answer));
      }
      if (answer) return *answer;
    }
  }

  void patch(session::json operations) { ask(session::PatchScene{std::move(operations), std::nullopt}); }

  void compare(const Hashes& run) {
    const session::Saved saved = stepper->saved();
    INFO("step " << saved.step);
    REQUIRE(run.contains(saved.step));
    CHECK(sim::state_hash(saved.state) == run.at(saved.step));
  }
};

/// A change and the way back, with no step between.
void change_there_and_back(Watched& session, const scene::Document& document) {
  const session::json solver = document.value["solver"];
  session::json other = solver;
  other["method"] = solver["method"] == "xpbd" ? "vbd" : "xpbd";
  session.patch({{"gravity", {0, -1, 3}}});
  session.patch({{"solver", other}});
  session.patch({{"solver", solver}});
  session.patch({{"gravity", document.value["gravity"]}});
  session.patch({{"solver", {{"dt", 0.5 * solver["dt"].get<double>()}}}});
  session.ask(session::TravelHistory{session::Direction::undo, std::nullopt});
}

void compare_session_with_run(const scene::Document& document) {
  const int steps = stretches * compared_every;
  const Hashes run = hashes_of_run(document.scene, steps + compared_every);
  std::set<std::uint64_t> distinct;
  for (const auto& [step, hash] : run) distinct.insert(hash);
  REQUIRE(distinct.size() > run.size() / 2);  // it moves

  Watched session(document);
  session.ask(session::Pause{});
  session.ask(session::Speed{0.01});
  const auto stretch = [&] {
    session.ask(session::Step{static_cast<std::uint64_t>(compared_every)});
    if (!session.diverged) session.compare(run);
    return !session.diverged;
  };
  if (!stretch()) return;

  session::Demand demand;
  for (const auto encoding : {stream::Encoding::q16, stream::Encoding::f32})
    demand.rate[static_cast<std::size_t>(encoding)] = 60;
  std::vector<session::Command> watching;
  watching.push_back({{}, session::Watchers{1}});
  watching.push_back({{}, demand});
  session.turn(std::move(watching));
  session.ask(session::RecordStart{60});
  const model::Model model = *model::build(document.scene);
  std::uint32_t vertex = 0;
  while (model.pin_motion[vertex] != model::not_pinned) ++vertex;
  session.ask(session::GrabStart{0, 0, vertex, {0, 2, 0}});
  session.ask(session::GrabEnd{0});
  session.compare(run);
  change_there_and_back(session, document);
  session.compare(run);
  if (!stretch()) return;

  session.ask(session::InspectContacts{16});
  session.ask(session::GetTimeline{});
  session.ask(session::RecordStop{});
  session.ask(session::Play{});
  for (int turns = 0; turns < 3; ++turns) session.turn();
  session.ask(session::Pause{});
  session.compare(run);
  const std::uint64_t now = session.stepper->saved().step;
  session.ask(session::Step{2u * static_cast<std::uint64_t>(compared_every) - now % compared_every});
  session.compare(run);

  // From a step between two kept states the run goes on as it did.
  session.ask(session::ResumeAt{static_cast<std::uint64_t>(compared_every + kept_every / 2)});
  session.compare(run);
  for (int k = 0; k < 2; ++k)
    if (!stretch()) return;
}

}  // namespace

TEST_CASE(
    "a session computes what a run computes, bit for bit, under each method, whatever is done to watch it") {
  for (const Method method : scene::methods)
    for (const std::string& kind : kinds_under(method)) {
      INFO(kind << " under " << scene::name(method));
      compare_session_with_run(under(busy(kind), method));
    }
}

TEST_CASE("a session of a scene with keys computes what a run computes, bit for bit, under each method") {
  for (const std::string kind : {"points", "surface"})
    for (const Method method : scene::methods) {
      // Verlet and BDF2 remember the last step, and VBD what presses: keys come between.
      const bool points = method == Method::verlet || method == Method::bdf2, surface = method == Method::vbd;
      if (!thorough && !(kind == "points" ? points : surface)) continue;
      INFO(kind << " under " << scene::name(method));
      compare_session_with_run(keyed(under(busy(kind), method)));
    }
}

TEST_CASE("a session of a preset computes what a run of it computes, bit for bit") {
  test::Part part(6);
  for (const std::string& name : scene::preset_names()) {
    if (part.leaves_out()) continue;
    const Result<scene::Document> preset = scene::load_preset(name);
    REQUIRE(preset);
    for (const Method method : scene::methods) {
      if (!thorough && method != preset->scene.solver.method) continue;
      INFO(name << " under " << scene::name(method));
      compare_session_with_run(under(*preset, method));
    }
  }
}
