// The watch for blow-ups, on the GPU and in the reference: sound scenes are never reported, unstable ones are
// found early, and the kept state is whole.
#include "server/sim/blow_up.h"

#include <optional>

#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/sim/guarded_run.h"
#include "tests/physics/stage.h"

using namespace clothlab;
using Verdict = sim::GuardedRun::Verdict;

namespace {

struct Watched {
  Verdict verdict = Verdict::good;
  int good = 0, looks = 0;
  sim::GuardedRun guard;
};

/// Steps to `time` [s]; the watch looks every `stride` steps.
Watched watch(sim::Simulation& simulation, double time, std::uint32_t stride) {
  Watched run{.guard = sim::GuardedRun(simulation)};
  run.guard.start(model::dt_limit(simulation.model(), simulation.scene()));
  while (run.verdict != Verdict::blown_up && simulation.time() < time) {
    run.guard.step(stride);
    run.verdict = run.guard.judge_now();
    ++run.looks;
    if (run.verdict == Verdict::good) ++run.good;
  }
  return run;
}

}  // namespace

TEST_CASE("no preset is taken for a blow-up, and nearly all of its states are ones to go back to") {
  const auto context = test::context();
  const double watched = test::thorough() ? 2.5 : 0.5;  // [s]
  test::Part part(4);
  for (const std::string& name : scene::preset_names()) {
    if (name == "blowup" || part.leaves_out()) continue;
    const auto simulation = test::simulation(preset(name));
    const Watched run = watch(*simulation, watched, 10);
    INFO(name << ": " << run.good << " of " << run.looks << " good");
    CHECK(run.verdict != Verdict::blown_up);
    CHECK(run.good > 0.9 * run.looks);
  }
}

TEST_CASE("the seed at 0.9 of its limit holds under every method that has one, beyond it it is found") {
  const auto context = test::context();
  for (const scene::Method method :
       {scene::Method::symplectic_euler, scene::Method::verlet, scene::Method::rk4}) {
    for (const double share : {0.9, 1.05}) {
      scene::Scene scene = test::seed();
      scene.solver.method = method;
      scene.solver.dt = share * model::dt_limit(*model::build(scene), scene);
      const auto simulation = test::simulation(scene);
      const Watched run = watch(*simulation, 3.0, 8);
      INFO("method " << static_cast<int>(method) << ", share " << share << ", at " << simulation->time());
      CHECK((run.verdict == Verdict::blown_up) == (share > 1.0));
    }
  }
}

TEST_CASE("a cloth that too few sweeps leave soft as rubber is no blow-up") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::pbd, scene::Method::xpbd, scene::Method::vbd}) {
    scene::Scene scene = test::seed();
    const auto simulation = test::simulation(scene);
    simulation->step(100);
    scene.solver = {method, 1.0 / 60, 1, 1e-4};
    REQUIRE(simulation->change(scene));
    const Watched run = watch(*simulation, 3.0, 1);
    INFO(scene::name(method) << ": " << run.good << " of " << run.looks << " good");
    CHECK(run.verdict != Verdict::blown_up);
    CHECK(run.good > 0.9 * run.looks);
  }
}

TEST_CASE("a strain limit, which moves vertices without a force, is no blow-up") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::verlet}) {
    scene::Scene scene = test::sheet(9, 9);
    scene.solver.method = method;
    scene.cloths[0].mass.value = 0.5;
    scene.cloths[0].springs().strain_limit = 0.05;
    scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
    const auto simulation = test::simulation(scene);
    const Watched run = watch(*simulation, 2.0, 16);
    INFO("method " << static_cast<int>(method) << ": " << run.good << " of " << run.looks << " good");
    CHECK(run.verdict != Verdict::blown_up);
    CHECK(run.good > 0.9 * run.looks);
  }
}

TEST_CASE("a collider put into the cloth, and one shot through it, are no blow-ups") {
  const auto context = test::context();
  scene::Scene scene = test::seed();
  scene.colliders[0].motion = scene::Linear{{0.0, 20.0, 0.0}};
  SECTION("shot") {
    scene.colliders[0].shape = scene::Sphere{{0.0, 0.0, 0.5}, 0.25};
  }
  SECTION("there from the start") {
    scene.colliders[0].shape = scene::Sphere{{0.0, 0.95, 0.5}, 0.3};
    scene.colliders[0].motion = {};
  }
  const auto simulation = test::simulation(scene);
  const Watched run = watch(*simulation, 1.0, 8);
  CHECK(run.verdict != Verdict::blown_up);
}

TEST_CASE("going back restores the kept state to the bit, and the simulation goes on from there as before") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::rk4}) {
    scene::Scene scene = test::seed();
    scene.solver.method = method;
    const auto simulation = test::simulation(scene);
    simulation->step(300);
    simulation->diagnose();
    simulation->keep_diagnosed();
    const std::uint64_t kept = sim::state_hash(simulation->read_state());
    simulation->step(100);
    const std::uint64_t later = sim::state_hash(simulation->read_state());
    simulation->diagnose();  // read, but not kept as good
    simulation->go_back();
    CHECK(simulation->step_index() == 300);
    CHECK(simulation->time() == Approx(0.3).epsilon(1e-12));
    CHECK(sim::state_hash(simulation->read_state()) == kept);
    simulation->step(100);
    CHECK(sim::state_hash(simulation->read_state()) == later);
  }
}

TEST_CASE("after a blow-up the last good state, with a step that holds, settles again") {
  const auto context = test::context();
  const auto simulation = test::simulation(preset("blowup"));
  Watched run = watch(*simulation, 1.0, 2);
  REQUIRE(run.verdict == Verdict::blown_up);
  CHECK_FALSE(run.guard.go_back().reason.empty());
  const sim::Diagnostics back = simulation->diagnose();
  CHECK(back.finite);
  CHECK(back.step == run.guard.last_good().step);
  CHECK(back.step == run.guard.state().step);
  CHECK(back.kinetic + back.elastic < 62.5 * 9.8 * 1.5);  // m g over the cloth's diagonal
  scene::Scene healed = preset("blowup");
  healed.solver.dt = 0.0013;
  REQUIRE(simulation->change(healed));
  CHECK(watch(*simulation, 2.0, 16).verdict == Verdict::good);
  CHECK(simulation->diagnose().max_strain < 0.5);
}

TEST_CASE("a look without waiting decides like one with waiting, and goes back to the same state") {
  const auto context = test::context();
  const auto waited = test::simulation(preset("blowup")), asked = test::simulation(preset("blowup"));
  sim::GuardedRun one(*waited), other(*asked);
  one.start(model::dt_limit(waited->model(), waited->scene()));
  other.start(model::dt_limit(asked->model(), asked->scene()));
  Verdict verdict = Verdict::good;
  while (verdict != Verdict::blown_up && waited->time() < 1.0) {
    one.step(2);
    other.step(2);
    other.request_verdict();
    std::optional<Verdict> arrived;
    while (!arrived) arrived = other.poll_verdict();
    verdict = one.judge_now();
    REQUIRE(*arrived == verdict);
    CHECK_FALSE(other.verdict_requested());
  }
  REQUIRE(verdict == Verdict::blown_up);
  CHECK(one.go_back().reason == other.go_back().reason);
  CHECK(waited->step_index() == asked->step_index());
  CHECK(sim::state_hash(waited->read_state()) == sim::state_hash(asked->read_state()));
}

TEST_CASE("a mass that was changed since the state was kept stays changed") {
  const auto context = test::context();
  const auto simulation = test::simulation(test::seed());
  scene::Scene heavy = test::seed();
  heavy.cloths[0].mass.value = 0.3;
  REQUIRE(simulation->change(heavy));
  const double weight = simulation->diagnose().gravitational;
  simulation->step(10);
  simulation->go_back();
  CHECK(simulation->diagnose().gravitational == Approx(weight).epsilon(1e-6));
}

TEST_CASE("after a blow-up below the limit, of a cloth that is pulled tight, one remedy holds") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::verlet}) {
    // Springs across the pull are slack at rest: they count for nothing there, and the more under tension.
    scene::Scene scene = test::sheet(9, 9);
    scene.gravity = {2.0, -9.8, 0.0};  // so that it swings across the pull
    scene.cloths[0].mass.value = 0.01;
    scene.cloths[0].material = scene::Springs{800.0, 0.0, 0.0, 0.0};
    scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, scene::Linear{{0.0, 0.0, -1.0}}},
                            {scene::AtEdge{scene::AtEdge::Line::row, 8}, scene::Linear{{0.0, 0.0, 1.0}}}};
    scene.solver.method = method;
    scene.solver.dt = 0.85 * model::dt_limit(*model::build(scene), scene);
    const auto simulation = test::simulation(scene);
    Watched run = watch(*simulation, 3.0, 8);
    INFO(scene::name(method) << " until " << simulation->time() << " s");
    REQUIRE(run.verdict == Verdict::blown_up);
    const model::Remedy remedy = run.guard.go_back().remedy;
    scene.solver.dt = remedy.dt;
    if (remedy.method) scene.solver.method = *remedy.method;
    REQUIRE(simulation->change(scene));
    CHECK(watch(*simulation, simulation->time() + 2.0, 8).verdict != Verdict::blown_up);
  }
}
