// The helper threads of software OpenGL on which a session computes; a session moves between them unharmed.
#include "server/session/engine.h"

#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/session/stepper.h"
#include "server/sim/cost.h"
#include "tests/scenes.h"

using namespace clothlab;
using gl::ComputePlace;
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

ComputePlace claim(const scene::Scene& scene) {
  return ComputePlace::claim(sim::expected_share(scene));
}

session::Command patch(scene::json what) {
  return {{1, scene::json(1)}, session::PatchScene{std::move(what), {}}};
}

}  // namespace

TEST_CASE("scenes that one core steps in real time are spread over two displays without helper threads") {
  const ComputePlace first = claim(test::seed());
  {
    const ComputePlace second = claim(test::seed());
    CHECK(first.threads() != HelperThreads::sessions);
    CHECK(second.threads() != HelperThreads::sessions);
    CHECK(first.threads() != second.threads());
  }
  const ComputePlace third = claim(test::seed());  // the second has given up its claim
  CHECK(third.threads() != first.threads());
  ComputePlace moved = claim(large_seed(256));
  moved = claim(large_seed(40));  // as much as three of the seed
  const ComputePlace fifth = claim(test::seed()), sixth = claim(test::seed());
  CHECK(fifth.threads() != moved.threads());
  CHECK(sixth.threads() != moved.threads());
}

TEST_CASE("sessions that share a display compute in turns, and one that takes long is not waited for") {
  using Turn = gl::DisplayTurn;
  auto first = std::make_unique<Turn>(HelperThreads::none);
  CHECK(first->others() == 0);
  { const Turn elsewhere(HelperThreads::none_too); }  // does not wait

  // Three more ask one after the other, while the first keeps its turn; each keeps its own for 5 ms.
  std::mutex mutex;
  std::vector<int> order;
  int at_once = 0;
  std::vector<std::thread> others;
  for (int i = 0; i < 3; ++i) {
    others.emplace_back([&, i] {
      const Turn turn(HelperThreads::none);
      {
        const std::lock_guard lock(mutex);
        CHECK(++at_once == 1);
        order.push_back(i);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      const std::lock_guard lock(mutex);
      --at_once;
    });
    // The next asks once this one waits, or has begun because the first has taken too long.
    const auto begun = [&] {
      const std::lock_guard lock(mutex);
      return order.size();
    };
    while (Turn::waiting(HelperThreads::none) + begun() < static_cast<std::size_t>(i) + 1)
      std::this_thread::yield();
  }
  for (std::thread& other : others) other.join();  // the first still has not ended
  CHECK(order == std::vector{0, 1, 2});
  first.reset();
  const Turn last(HelperThreads::none);
  CHECK(last.others() == 0);
}

TEST_CASE("a scene is heavy if one core could not step it in real time, and stays so near the boundary") {
  const auto heavy = [](const scene::Scene& scene) {
    return claim(scene).threads() == HelperThreads::sessions;
  };
  CHECK_FALSE(heavy(test::seed()));
  CHECK(heavy(large_seed(256)));
  scene::Scene scene = test::seed();
  scene.solver.method = scene::Method::xpbd;
  scene.solver.iterations = 10000;
  CHECK(heavy(scene));
  scene = large_seed(100);
  scene.self_collision->thickness = 10.0;
  CHECK(heavy(scene));

  scene = test::seed();
  scene.solver.dt = sim::expected_step_seconds(scene) / 0.6;
  ComputePlace light = claim(test::seed()), helped = claim(large_seed(256));
  CHECK(light.stays(sim::expected_share(scene)));
  CHECK(helped.stays(sim::expected_share(scene)));
  CHECK_FALSE(light.stays(sim::expected_share(large_seed(256))));
  CHECK_FALSE(helped.stays(sim::expected_share(test::seed())));
}

TEST_CASE("heavy scenes have helper threads of their own, which give way") {
  session::Exchange exchange{[] {}};
  const auto light = session::Engine::create(test::seed(), exchange, {});
  REQUIRE(light);
  if (!(*light)->place) return;  // a GPU has none
  const std::map<int, int> before = threads();
  const auto heavy = session::Engine::create(large_seed(256), exchange, {});
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
    "the lab's display computes with helper threads or without, as its scene needs, once nothing else uses "
    "it") {
  gl::compute_without_helper_threads();
  const auto create = [](bool helped) {
    Result<std::unique_ptr<gl::Context>> context =
        gl::Context::create(std::nullopt, HelperThreads::lab, helped);
    REQUIRE(context);
    return std::move(*context);
  };
  if (!create(false)->device().software) return;  // a GPU has none
  std::set<std::uint64_t> hashes;
  for (const bool helped : {true, false, true, true, false}) {
    const std::unique_ptr<gl::Context> context = create(helped);
    CHECK(gl::computes_on_calling_thread() == !helped);
    const Result<std::unique_ptr<sim::Simulation>> simulation = sim::Simulation::create(test::seed());
    REQUIRE(simulation);
    (*simulation)->step(10);
    hashes.insert(sim::state_hash((*simulation)->read_state()));
  }
  CHECK(hashes.size() == 1);
  std::unique_ptr<gl::Context> picture = create(true);
  picture->release_current();
  std::atomic<bool> opened{false};
  std::thread lab([&] {
    const std::unique_ptr<gl::Context> context = create(false);
    opened = true;
    CHECK(gl::computes_on_calling_thread());
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(!opened);
  picture.reset();
  lab.join();
  CHECK(opened);
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
      for (session::Command& command : commands) exchange.post(std::move(command));
      std::this_thread::sleep_until(
          std::min((*stepper)->turn(), session::Clock::now() + std::chrono::milliseconds(5)));
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
