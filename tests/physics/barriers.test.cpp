// Nothing depends on what OpenGL leaves open: what a dispatch writes is read behind a barrier, and it does
// not matter which work group comes first. Software OpenGL shows neither, as it carries out one group after
// the other.
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/render/renderer.h"
#include "server/scene/suited.h"
#include "server/selftest/scenes.h"
#include "server/sim/kept_states.h"
#include "server/stream/packer.h"
#include "tests/checked_context.h"

using namespace clothlab;

namespace {

struct Named {
  std::string name;
  std::function<std::unique_ptr<sim::Simulation>()> make;
};

/// The short scenes of the selftest, which have all methods and all that scenes can have; and, if thorough,
/// all presets under all methods that suit them. `quick`: of the short scenes, otherwise, half of those that
/// take no time.
std::vector<Named> simulations(bool quick) {
  std::vector<Named> all;
  const Result<std::vector<selftest::ShortRun>> runs = selftest::short_runs();
  REQUIRE(runs);
  test::Part part(2);
  for (const selftest::ShortRun& run : *runs)
    if (!quick || test::thorough() || (run.quick && !part.leaves_out()))
      all.push_back({run.name, [run] {
                       auto made = selftest::started(run);
                       REQUIRE(made);
                       return std::move(*made);
                     }});
  if (!test::thorough()) return all;
  for (const std::string& preset : scene::preset_names()) {
    scene::Scene scene = scene::load_preset(preset)->scene;
    const std::vector<scene::Method> methods = *scene::suited_methods(scene, {});
    for (const scene::Method method : methods) {
      scene.solver.method = method;
      all.push_back({preset + ", " + scene::name(method), [scene] { return test::simulation(scene); }});
    }
  }
  return all;
}

constexpr std::uint32_t steps = 3;

/// Steps, and all that looks at a state or brings another one back.
void use(sim::Simulation& simulation, stream::Packer& packer) {
  simulation.diagnose_every(1);
  simulation.keep_state();
  simulation.step(steps);
  for (const stream::Form form :
       {stream::Form(stream::Encoding::q16, stream::Field::strain), stream::Form(stream::Encoding::f32)}) {
    packer.request(simulation, form, 0);
    packer.wait();
  }
  simulation.diagnose();
  simulation.keep_diagnosed();
  simulation.step(1);
  simulation.go_back();
  simulation.step(1);
  const sim::State state = simulation.read_state();
  REQUIRE(simulation.go_to_kept(0, simulation.scene()));
  simulation.step(1);
  simulation.restore(state, 0.0, 0);
  simulation.step(1);
  simulation.reset();
  simulation.step(1);
}

}  // namespace

TEST_CASE("no barrier is missing, whatever scene runs under whatever method, is watched, kept and put back") {
  const test::BarrierContext context;
  const auto packer = stream::Packer::create();
  REQUIRE(packer);
  for (const Named& named : simulations(false)) {
    const std::size_t before = context.faults().size();
    use(*named.make(), **packer);
    INFO(named.name);
    CHECK(context.faults().size() == before);
  }
  for (const std::string& fault : context.faults()) UNSCOPED_INFO(fault);
  CHECK(context.faults().empty());
}

TEST_CASE("no barrier is missing in a picture of cloth that has just been stepped") {
  const test::BarrierContext context;
  const auto renderer = render::Renderer::create();
  REQUIRE(renderer);
  const auto simulation = test::simulation(test::seed());
  simulation->step(steps);
  const std::vector<glm::vec3> positions = simulation->read_state().position;
  REQUIRE((*renderer)->render(
      {simulation->scene(), simulation->model(), positions, simulation->colliders_now()}, 64, 64));
  for (const std::string& fault : context.faults()) UNSCOPED_INFO(fault);
  CHECK(context.faults().empty());
}

TEST_CASE("a barrier that is missing is found: two dispatches of a method with none between them") {
  const test::BarrierContext context;
  const auto simulation = test::simulation(test::seed());
  const auto barrier = glad_glMemoryBarrier;
  glad_glMemoryBarrier = [](GLbitfield) {};
  simulation->step(2);
  glad_glMemoryBarrier = barrier;
  CHECK_FALSE(context.faults().empty());
}

TEST_CASE("no bit depends on the order of work groups: with the last one first a state is the same") {
  const auto hashes = [] {
    const auto context = test::context();
    std::vector<std::uint64_t> all;
    for (const Named& named : simulations(true)) {
      const auto simulation = named.make();
      simulation->step(steps);
      all.push_back(sim::state_hash(simulation->read_state()));
    }
    return all;
  };
  const std::vector<std::uint64_t> forwards = hashes();
  std::vector<std::uint64_t> backwards;
  {
    const test::Variable reversed("CLOTHLAB_GROUP_ORDER", "reversed");
    backwards = hashes();
  }
  test::context();  // later contexts' programs are as they are
  const std::vector<Named> all = simulations(true);
  for (std::size_t i = 0; i < all.size(); ++i) {
    INFO(all[i].name);
    CHECK(forwards[i] == backwards[i]);
  }
}
