// The helper threads of software OpenGL on which a session computes; a session moves between them unharmed.
#include "server/session/engine.h"

#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "server/session/stepper.h"
#include "server/sim/cost.h"
#include "tests/scenes.h"

using namespace clothlab;
using gl::HelperThreads;

namespace {

/// The process's threads and their niceness.
std::map<int, int> threads() {
  std::map<int, int> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
    const int thread = std::stoi(entry.path().filename().string());
    found[thread] = getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
  }
  return found;
}

scene::Scene large_seed(int side) {
  scene::Scene scene = test::seed();
  scene.cloths[0].mesh = scene::Grid{side, side, 1.0, 1.0};
  scene.cloths[0].pins.clear();
  return scene;
}

session::Command patch(scene::json what) {
  return {{1, scene::json(1)}, session::PatchScene{std::move(what), {}}};
}

}  // namespace

TEST_CASE(
    "a scene is heavy where software OpenGL could not step it in real time, and stays so near the boundary") {
  const auto threads_for = session::Engine::threads_for;
  CHECK(threads_for(test::seed(), HelperThreads::light_sessions) == HelperThreads::light_sessions);
  CHECK(threads_for(large_seed(64), HelperThreads::light_sessions) == HelperThreads::light_sessions);
  CHECK(threads_for(large_seed(256), HelperThreads::light_sessions) == HelperThreads::heavy_sessions);
  scene::Scene scene = test::seed();
  scene.solver.method = scene::Method::xpbd;
  scene.solver.iterations = 10000;
  CHECK(threads_for(scene, HelperThreads::light_sessions) == HelperThreads::heavy_sessions);
  scene = large_seed(100);
  scene.self_collision->thickness = 10.0;
  CHECK(threads_for(scene, HelperThreads::light_sessions) == HelperThreads::heavy_sessions);

  scene = test::seed();
  scene.solver.dt = 1.2 * sim::expected_step_seconds(scene);
  CHECK(threads_for(scene, HelperThreads::light_sessions) == HelperThreads::light_sessions);
  CHECK(threads_for(scene, HelperThreads::heavy_sessions) == HelperThreads::heavy_sessions);
}

TEST_CASE("heavy scenes have helper threads of their own, which give way") {
  session::Exchange exchange{[] {}};
  const auto light = session::Engine::create(test::seed(), exchange, {});
  REQUIRE(light);
  if (!(*light)->software()) return;  // a GPU has none
  const std::map<int, int> before = threads();
  session::Engine::Wanted wanted;
  wanted.threads = HelperThreads::heavy_sessions;
  const auto heavy = session::Engine::create(test::seed(), exchange, wanted);
  REQUIRE(heavy);
  int added = 0;
  for (const auto& [thread, niceness] : threads()) {
    if (before.contains(thread)) continue;
    CHECK(niceness >= 5);
    ++added;
  }
  CHECK(added > 1);
}

TEST_CASE(
    "a session whose scene becomes heavy and light again goes on where it was, and its frames are numbered "
    "on") {
  session::Exchange exchange{[] {}};
  Result<scene::Document> seed = scene::load_preset("seed");
  REQUIRE(seed);
  Result<std::unique_ptr<session::Stepper>> stepper =
      session::Stepper::create(std::move(*seed), exchange, session::Limits());
  REQUIRE(stepper);
  std::vector<session::Command> commands;
  const auto turn_until = [&](auto done) {
    const auto late = session::Clock::now() + std::chrono::seconds(60);
    while (!done() && session::Clock::now() < late) {
      std::this_thread::sleep_until(
          std::min((*stepper)->turn(commands), session::Clock::now() + std::chrono::milliseconds(5)));
      commands.clear();
    }
    REQUIRE(done());
  };
  const auto frame = [&] { return exchange.frame(stream::Encoding::f32); };
  session::Demand demand;
  demand.rate[static_cast<std::size_t>(stream::Encoding::f32)] = 60;
  commands = {{{}, session::Watchers{1}}, {{}, demand}};
  turn_until([&] { return frame() && frame()->header.step > 300; });

  std::uint64_t steps = frame()->header.step;
  std::uint32_t sequence = frame()->header.sequence, topology = frame()->header.topology_revision;
  // The kernels differ, the cloth is the same.
  for (const char* method : {"xpbd", "symplectic_euler"}) {
    const int iterations = std::string(method) == "xpbd" ? 5000 : 10;
    commands = {patch({{"solver", {{"method", method}, {"iterations", iterations}}}})};
    turn_until([&] { return frame() && frame()->header.step > steps; });
    CHECK(frame()->header.sequence > sequence);
    CHECK(frame()->header.topology_revision == topology);
    CHECK(frame()->header.step < steps + 100);  // it did not begin anew, and lost no step
    steps = frame()->header.step;
    sequence = frame()->header.sequence;
  }
  // Another mesh is another topology.
  commands = {patch({{"cloths", {{{"mesh", {{"grid", {{"columns", 200}, {"rows", 200}}}}}}}}})};
  turn_until([&] { return frame() && frame()->header.vertex_count == 40000 && frame()->header.step > 0; });
  CHECK(frame()->header.topology_revision > topology);
  CHECK(frame()->header.sequence > sequence);
}
