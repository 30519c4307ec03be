// Numbers at the limits of what a document may say, under every method: a clear error
// (tests/unit/scene_validate) or a run that stays finite and within the energy there is.
#include <algorithm>
#include <cmath>

#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/scene/ranges.h"
#include "tests/methods.h"
#include "tests/physics/stage.h"

using namespace clothlab;

namespace {

/// A time step [s] well below the method's limit. If no step is stable (explicit Euler without damping), one
/// so short that the growth, (1 + (omega dt)^2)^(N/2), stays small over some hundred steps; if all are, one
/// of the usual length.
double gentle_dt(const scene::Scene& scene) {
  const model::Model model = *model::build(scene);
  const double limit = model::dt_limit_bound(model, scene), omega = model::omega_bound(model, scene);
  const double wanted = limit == 0.0 ? 0.02 / omega : 0.1 * limit;
  return std::clamp(wanted, scene::ranges::dt.minimum, 1e-3);
}

/// `body(scene)` for the scene under every method, with a time step that suits the method.
template <class Body>
void under_every_method(scene::Scene scene, Body body) {
  for (const scene::Method method : test::tried_of(scene::methods)) {
    scene.solver.method = method;
    scene.solver.dt = gentle_dt(scene);
    INFO(scene::name(method) << ", dt " << scene.solver.dt << " s");
    body(scene);
  }
}

/// Error of the energies [J] that float32 positions about 1 m from the origin leave: an ulp of height, and of
/// the length of a spring.
double energy_noise(const sim::Simulation& simulation) {
  const model::Model& model = simulation.model();
  const double ulp = 0x1p-23;
  double noise = 0.0;
  for (const double mass : model.mass) noise += mass * glm::length(simulation.scene().gravity) * ulp;
  for (const model::Spring& spring : model.springs())
    noise += spring.law.stiffness * std::pow((1.0 + spring.law.rest_length) * 2.0 * ulp, 2);
  return noise;
}

/// Steps, and checks that pins hold and that motion and stretch have no more energy than gravity has given.
/// Returns that energy [J]. A tenth of the limit keeps the energy that a first-order method shows within 1/(1
/// - 0.1) of the one that it conserves. Another tenth is allowed for the growth of explicit Euler.
double stays_within_its_energy(sim::Simulation& simulation, std::uint32_t steps) {
  const sim::Diagnostics before = simulation.diagnose();
  simulation.step(steps);
  const sim::Diagnostics after = simulation.diagnose();
  CHECK(after.finite);
  CHECK(after.step == steps);
  const sim::State state = simulation.read_state();
  for (std::uint32_t i = 0; i < state.position.size(); ++i)
    if (simulation.model().pin_motion[i] != model::not_pinned)
      CHECK(state.position[i] == glm::vec3(simulation.model().rest_position[i]));
  const double paid = before.gravitational - after.gravitational;
  CHECK(after.kinetic + after.elastic <= 1.2 * paid + energy_noise(simulation));
  return paid;
}

void falls_within_its_energy(const scene::Scene& scene, std::uint32_t steps) {
  const auto simulation = test::simulation(scene);
  CHECK(stays_within_its_energy(*simulation, steps) > energy_noise(*simulation));
}

scene::Scene hung(const scene::Springs& material) {
  scene::Scene scene = test::sheet(7, 5);
  scene.cloths[0].material = material;
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{6, 0}, {}}};
  return scene;
}

}  // namespace

TEST_CASE("springs of 1e-30 N/m let a cloth fall freely under every method, without a NaN") {
  const auto context = test::context();
  under_every_method(hung({1e-30, 1e-30, 1e-30, 0.0}), [](const scene::Scene& scene) {
    const auto simulation = test::simulation(scene);
    const int steps = 200;
    simulation->step(steps);
    const double t = steps * scene.solver.dt, fallen = 0.5 * 9.8 * t * t;
    const sim::State state = simulation->read_state();
    for (std::uint32_t i = 0; i < state.position.size(); ++i) {
      const bool pinned = simulation->model().pin_motion[i] != model::not_pinned;
      // A method of order 1 is off by half a step: g t dt / 2. Each of N sums rounds by half an ulp of 1 m.
      CHECK(std::abs(1.0 - state.position[i].y - (pinned ? 0.0 : fallen)) <=
            0.5 * 9.8 * t * scene.solver.dt * 1.001 + steps * 0x1p-24);
    }
    CHECK(simulation->diagnose().finite);
  });
}

TEST_CASE("springs of 1e12 N/m hold under every method when the step is below its limit") {
  const auto context = test::context();
  scene::Scene scene = hung({1e12, 1e12, 1e12, 1e8});
  scene.cloths[0].mass.value =
      1e6;  // also the largest allowed, so that the cloth moves in some hundred steps
  under_every_method(scene, [](const scene::Scene& each) { falls_within_its_energy(each, 300); });
}

TEST_CASE("masses a million times apart in one mesh hold under every method") {
  const auto context = test::context();
  // The triangle at the corner is a thousand times smaller: its free vertices weigh a millionth.
  const scene::Scene scene = scene_of(R"({"version": 1, "gravity": [0, -10000, 0], "cloths": [{
    "mesh": {"vertices": [[0,0,0], [1,0,0], [0,0,1], [-0.001,0,0], [0,0,-0.001]], "triangles": [[0,2,1], [0,3,4]]},
    "mass": {"area_density": 1}, "transform": {"translate": [0, 1, 0]}, "pins": [{"at": "vertex:1"}],
    "material": {"structural": 100, "shear": 0, "bend": 0, "damping": 0.004}}]})");
  const model::Model model = *model::build(scene);
  REQUIRE(model.mass[2] / model.mass[3] > 0.99e6);
  under_every_method(scene, [](const scene::Scene& each) { falls_within_its_energy(each, 500); });
}

TEST_CASE("a cloth a million times heavier than the one it lands on stays finite under every method") {
  const auto context = test::context();
  scene::Scene scene = hung({200.0, 100.0, 20.0, 0.01});
  scene.cloths[0].mass.value = 1e-3;
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "heavy";
  scene.cloths[1].pins.clear();
  scene.cloths[1].mass.value = 1e3;
  scene.cloths[1].transform.translate.y = 1.02;
  scene.self_collision = scene::SelfCollision{0.015, 0.2};
  under_every_method(scene, [](const scene::Scene& each) {
    const auto simulation = test::simulation(each);
    simulation->step(300);
    const sim::Diagnostics after = simulation->diagnose();
    CHECK(after.finite);
    // The light cloth gets at most the speed of an elastic blow by the heavy one: twice its speed.
    CHECK(after.max_speed <= 2.0 * 9.8 * 300 * each.solver.dt * 1.01);
  });
}

TEST_CASE("a cloth with every vertex pinned does not move under any method") {
  const auto context = test::context();
  scene::Scene scene = hung({20000.0, 10000.0, 2000.0, 2.0});
  scene.cloths[0].pins = {{scene::AtBox{glm::dvec3(-9.0), glm::dvec3(9.0)}, {}}};
  under_every_method(scene, [](const scene::Scene& each) {
    const auto simulation = test::simulation(each);
    const std::uint64_t before = sim::state_hash(simulation->read_state());
    simulation->step(50);
    CHECK(sim::state_hash(simulation->read_state()) == before);
    CHECK(simulation->diagnose().kinetic == 0.0);
  });
}

TEST_CASE("a cloth without a pin falls as a whole under every method") {
  const auto context = test::context();
  scene::Scene scene = hung({2000.0, 1000.0, 200.0, 0.2});
  scene.cloths[0].pins.clear();
  under_every_method(scene, [](const scene::Scene& each) {
    const auto simulation = test::simulation(each);
    simulation->step(200);
    const sim::Diagnostics after = simulation->diagnose();
    CHECK(after.finite);
    // Only rounding stretches its springs: an ulp of a metre, over the shortest of them.
    CHECK(after.max_strain < 200 * 0x1p-23 / (1.0 / 6.0));
    CHECK(after.max_speed == Approx(9.8 * 200 * each.solver.dt).epsilon(1e-4));
  });
}

TEST_CASE("the smallest cloths, one triangle and four vertices, hang under every method") {
  const auto context = test::context();
  scene::Scene square = test::sheet(2, 2);
  square.cloths[0].material = scene::Springs{200.0, 100.0, 20.0, 0.1};
  square.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}};
  const scene::Scene triangle = scene_of(R"({"version": 1, "cloths": [{
    "mesh": {"vertices": [[0,1,0], [0,1,1], [1,1,0]], "triangles": [[0,1,2]]}, "pins": [{"at": "vertex:0"}],
    "material": {"structural": 200, "shear": 0, "bend": 0, "damping": 0.1}}]})");
  for (const scene::Scene& scene : {square, triangle})
    under_every_method(scene, [](const scene::Scene& each) { falls_within_its_energy(each, 300); });
}

TEST_CASE("implicit Euler holds with steps of a second, whatever the stiffness and the masses") {
  const auto context = test::context();
  for (const double stiffness : {1e-30, 200.0, 1e12}) {
    for (const double mass : {1e-9, 1e-3, 1e6}) {
      scene::Scene scene = hung({stiffness, stiffness, stiffness, 0.0});
      scene.cloths[0].mass.value = mass;
      scene.solver = {scene::Method::implicit_euler, 1.0, 1, 1e-4};
      INFO("stiffness " << stiffness << " N/m, mass " << mass << " kg");
      const auto simulation = test::simulation(scene);
      simulation->step(20);
      const sim::Diagnostics after = simulation->diagnose();
      CHECK(after.finite);
      CHECK(after.max_speed <= 9.8 * 21);  // 20 s of free fall and one step too many
      // The overshoot of the first step, which no spring of a flat cloth holds back, has died away.
      const double weight = 35 * mass * 9.8, stretch = weight / (stiffness * 0.167);
      if (stretch < 0.05) CHECK(after.max_strain < 0.05);
    }
  }
}

TEST_CASE("a strain limit that pins or springs without length make impossible leaves every number finite") {
  const auto context = test::context();
  scene::Scene torn = hung({2000.0, 1000.0, 200.0, 0.2});
  torn.cloths[0].pins[1].motion = scene::Linear{glm::dvec3(500.0, 0.0, 0.0)};  // a pin flies away with it
  scene::Scene held = hung({2000.0, 1000.0, 200.0, 0.2});
  held.cloths[0].pins = {{scene::AtBox{glm::dvec3(-9.0), glm::dvec3(9.0)}, {}}};
  const scene::Scene lengthless = scene_of(R"({"version": 1, "cloths": [{
    "mesh": {"vertices": [[0,1,0], [0,1,0], [0,1,0], [1,1,0], [0,1,1]],
             "triangles": [[0,1,2], [0,1,3], [1,2,4], [3,4,0]]}, "pins": [{"at": "vertex:3"}],
    "material": {"structural": 2000, "shear": 0, "bend": 200, "damping": 0.2}}]})");
  for (scene::Scene scene : {torn, held, lengthless}) {
    for (const double limit : {scene::ranges::strain_limit.minimum, scene::ranges::strain_limit.maximum}) {
      scene.cloths[0].springs().strain_limit = limit;
      INFO("limit " << limit);
      under_every_method(scene, [](const scene::Scene& each) {
        const auto simulation = test::simulation(each);
        simulation->step(40);
        CHECK(simulation->diagnose().finite);
      });
    }
  }
}
