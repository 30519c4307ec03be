// The preset flag over ten seconds of wind, and the watch for blow-ups in wind.
#include <algorithm>
#include <cmath>

#include "server/model/stability.h"
#include "server/model/wind.h"
#include "server/sim/guarded_run.h"
#include "tests/physics/stage.h"

using namespace clothlab;
using Verdict = sim::GuardedRun::Verdict;

namespace {

double free_mass(const model::Model& model) {
  double mass = 0.0;
  for (std::uint32_t i = 0; i < model.vertex_count(); ++i)
    if (model.pin_motion[i] == model::not_pinned) mass += model.mass[i];
  return mass;
}

/// Steps to `time` [s], looking 60 times a second; true if no look finds a blow-up.
template <class Look>
bool holds(sim::Simulation& simulation, double time, Look look) {
  sim::GuardedRun guard(simulation);
  guard.start(model::dt_limit(simulation.model(), simulation.scene()));
  const auto stride = static_cast<std::uint32_t>(std::ceil(1.0 / 60 / simulation.scene().solver.dt));
  while (simulation.time() < time) {
    guard.step(stride);
    if (guard.judge_now() == Verdict::blown_up) return false;
    look(guard.state());
  }
  return true;
}

}  // namespace

TEST_CASE("a flag in the wind neither gains energy without bound nor stops, over ten seconds") {
  const auto context = test::context();
  const scene::Scene scene = preset("flag");
  REQUIRE(scene.wind);
  const auto simulation = test::simulation(scene);
  const double speed = model::largest_wind_speed(*scene.wind), mass = free_mass(simulation->model());
  double most = 0.0, first_half = 0.0, second_half = 0.0;
  int looks[2] = {0, 0};
  const bool held = holds(*simulation, 10.0, [&](const sim::Diagnostics& state) {
    most = std::max(most, state.kinetic);
    if (state.time < 2.0) return;  // it has unfurled
    (state.time < 6.0 ? first_half : second_half) += state.kinetic;
    ++looks[state.time < 6.0 ? 0 : 1];
  });
  CHECK(held);
  first_half /= looks[0];
  second_half /= looks[1];
  INFO("kinetic energy: at most " << most << " J, on average " << first_half << " J, then " << second_half
                                  << " J; the whole flag at the wind's speed: "
                                  << 0.5 * mass * speed * speed);
  // What flies with the wind has no more than the wind's speed; a flag is held, and only whips.
  CHECK(most < 0.5 * mass * speed * speed);
  // It goes on as strongly as it did: flutter neither grows nor dies.
  CHECK(second_half > 0.33 * first_half);
  CHECK(second_half < 3.0 * first_half);
  CHECK(second_half > 0.5 * mass * 0.2 * 0.2);  // at 0.2 m/s on average a viewer sees it move
}

TEST_CASE("a step beyond the limit is found in wind too, and one below it holds") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::verlet}) {
    for (const double share : {0.9, 1.1}) {
      scene::Scene scene = preset("flag");
      scene.solver.method = method;
      scene.solver.dt = share * model::dt_limit(*model::build(scene), scene);
      const auto simulation = test::simulation(scene);
      INFO("method " << static_cast<int>(method) << ", share " << share);
      CHECK(holds(*simulation, 1.5, [](const sim::Diagnostics&) {}) == (share < 1.0));
    }
  }
}

TEST_CASE("a sheet that a strong wind takes along is no blow-up, since the wind does work on it") {
  // From rest without gravity: all its energy is the wind's. Allowances for a scene without wind know of
  // none.
  const auto context = test::context();
  scene::Scene scene = test::sheet(5, 5);
  scene.gravity = glm::dvec3(0.0);
  scene.cloths[0].mass.value = 0.04;  // a kilogram: it takes some looks to reach its speed
  scene.cloths[0].material = scene::Springs{50.0, 25.0, 1.0, 0.02};
  scene.wind = scene::Wind{{5.0, 20.0, 0.0}, 0.5, 2.0, 1.0, 0.5};
  scene::Scene calm = scene;
  calm.wind.reset();
  const auto simulation = test::simulation(scene);
  sim::BlowUp watch, blind;
  watch.start(sim::allowance(scene, simulation->model(), model::no_limit), simulation->diagnose());
  blind.start(sim::allowance(calm, simulation->model(), model::no_limit), simulation->diagnose());
  bool seen = false, seen_blindly = false;
  for (int look = 0; look < 120; ++look) {
    simulation->step(16);
    const sim::Diagnostics state = simulation->diagnose();
    seen = seen || watch.judge(state) == Verdict::blown_up;
    seen_blindly = seen_blindly || blind.judge(state) == Verdict::blown_up;
  }
  CHECK_FALSE(seen);
  CHECK(seen_blindly);
}
