// Keys of the scene over time, on the GPU and in the reference, under every method: against closed forms,
// against each other, and whatever is done between steps.
#include <glm/geometric.hpp>

#include "server/reference/follower.h"
#include "server/reference/trajectory.h"
#include "server/scene/keys.h"
#include "server/sim/kept_states.h"
#include "tests/methods.h"
#include "tests/physics/stage.h"
#include "tests/sides.h"

using namespace clothlab;
using glm::dvec3;
using scene::Ease;
using scene::Method;

namespace {

/// A sheet that no pin holds and nothing strains: it falls as a whole.
scene::Scene free_sheet(Method method, double dt) {
  scene::Scene scene = test::sheet(3, 3);
  scene.gravity = dvec3(0.0);
  scene.solver = {.method = method, .dt = dt, .iterations = 4};
  scene.cloths[0].material =
      scene::Springs{10.0, 10.0, 10.0, 0.1};  // soft: each method is stable with such steps
  return scene;
}

scene::Key key(const std::string& of, std::vector<double> times, std::vector<dvec3> values,
               Ease ease = Ease::linear) {
  return {of, ease, std::move(times), std::move(values)};
}

scene::Key lets_go(int pin, double time) {
  return key("/cloths/0/pins/" + std::to_string(pin) + "/held", {0.0, time}, {dvec3(1, 0, 0), dvec3(0.0)},
             Ease::step);
}

/// How far all vertices of a sheet that falls as a whole are from where `way` takes them, at most [m].
double off(const reference::State& state, const reference::World& world, const dvec3& way) {
  double most = 0.0;
  for (std::size_t i = 0; i < state.position.size(); ++i)
    most = std::max(most, glm::distance(state.position[i], world.model.rest_position[i] + way));
  return most;
}

/// A sheet with something of all that can be keyed, hung by two corners of which one moves.
scene::Scene busy(Method method, const char* material) {
  scene::Scene scene = scene_of(std::string(R"({"version": 1,
    "cloths": [{"mesh": {"grid": {"columns": 9, "rows": 9, "width": 0.4, "height": 0.4}},
                "transform": {"translate": [0, 0.5, 0]}, "mass": {"area_density": 0.15},
                "material": )") +
                                material + R"(,
                "pins": [{"at": "corner:0,0"},
                         {"at": "corner:8,0", "motion": {"linear": {"velocity": [0, 0, 0.5]}}}]}],
    "colliders": [{"sphere": {"center": [0, 0.385, 0.2], "radius": 0.1}, "friction": 0.2}],
    "wind": {"velocity": [1, 0, 0], "gust": 0.2}, "air_drag": 0.1, "solver": {"dt": 0.0005, "iterations": 4}})");
  scene.solver.method = method;
  // Its step must be shorter than damping over stiffness.
  if (method == Method::explicit_euler) scene.solver.dt = 2e-5;
  if (method == Method::implicit_euler) scene.solver.iterations = 20;  // the reference solves a step whole
  return scene;
}

constexpr const char* springs = R"({"structural": 200, "shear": 100, "bend": 20, "damping": 0.02})";
constexpr const char* sheet =
    R"({"model": "fem", "warp": 60, "weft": 80, "shear": 20, "bending": 1e-4, "damping": 0.001})";

/// Keys of all of it, within 200 steps; a pin lets go at the 80th.
std::vector<scene::Key> all_keys(const scene::Scene& scene) {
  const std::string material = "/cloths/0/material/";
  const double step = scene.solver.dt;
  std::vector<scene::Key> keys = {
      key("/gravity", {0, 100 * step, 160 * step}, {{0, -9.8, 0}, {6, -4, 0}, {0, -2, 4}}, Ease::smooth),
      key("/air_drag", {20.5 * step, 120 * step}, {dvec3(0.0), dvec3(4, 0, 0)}),
      key("/wind/velocity", {0, 140 * step}, {dvec3(0.0), dvec3(3, 2, 0)}),
      key("/wind/drag", {40 * step, 81 * step}, {dvec3(0.5, 0, 0), dvec3(1.5, 0, 0)}, Ease::step),
      key("/colliders/0/friction", {0, 160 * step}, {dvec3(0.0), dvec3(0.8, 0, 0)}),
      key(material + "damping", {0, 180 * step},
          {dvec3(scene.cloths[0].damping(), 0, 0), dvec3(0.8 * scene.cloths[0].damping(), 0, 0)}),
      lets_go(0, 80 * step),
  };
  const auto stiffens = [&](const char* of, double from, double to) {
    keys.push_back(key(material + of, {0, 160 * step}, {dvec3(from, 0, 0), dvec3(to, 0, 0)}));
  };
  if (std::holds_alternative<scene::Fem>(scene.cloths[0].material)) {
    stiffens("warp", 60, 120);
    stiffens("bending", 1e-4, 3e-4);
  } else {
    for (const char* of : {"structural", "shear", "bend"}) stiffens(of, 60, 150);
  }
  return keys;
}

std::uint64_t hash(sim::Simulation& simulation) {
  return sim::state_hash(simulation.read_state());
}

}  // namespace

TEST_CASE(
    "a cloth that falls under keyed gravity follows the double integral of the key's law, by the method's "
    "order") {
  const auto context = test::context();
  constexpr double time = 0.4, most = 10.0;
  constexpr int steps = 200;
  constexpr double dt = time / steps;
  // 10 t / 0.4 sideways: 10 / 0.4 * t^3 / 6.
  const dvec3 way(most * time * time / 6.0, 0.0, 0.0);
  for (const test::Side side : test::sides)
    for (const Method method : test::tried_of(scene::methods)) {
      INFO(scene::name(method) << ", " << test::name(side));
      scene::Scene scene = free_sheet(method, dt);
      scene.keys = {key("/gravity", {0.0, time}, {dvec3(0.0), dvec3(most, 0, 0)})};
      test::Stepped stepped(side, scene);
      stepped.step(steps);
      // Of the first order: velocities, and places by these, are off by what a step adds at most. Of the
      // second: by the trapezoidal rule's dt^2 / 12 of the change of what is summed, twice. RK4 integrates
      // such a law exactly. Float32 rounds places and velocities in each step, by 1.2e-7 of up to 2 m or 2
      // m/s, independently.
      const double rounding = side == test::Side::gpu ? 2.4e-7 * steps : 1e-12;
      // BDF2's error has four times the trapezoid's factor.
      const double first = dt * most * time, second = (method == Method::bdf2 ? 4 : 1) * dt * dt * most;
      const int order = scene::facts(method).order;
      CHECK(off(stepped.state(), stepped.world(), way) < rounding + (order == 1   ? first
                                                                     : order == 2 ? second
                                                                                  : 0.0));
    }
}

TEST_CASE("a pin that lets go leaves its vertices the velocity of its motion: they fly on, and fall") {
  const auto context = test::context();
  constexpr double dt = 0.001, go = 0.1, time = 0.3;
  const dvec3 velocity(0.7, 0.2, -0.4), gravity(0, -9.8, 0);
  for (const bool moves : {true, false})
    for (const test::Side side : test::sides)
      for (const Method method : test::tried_of(scene::methods)) {
        INFO(scene::name(method) << ", " << test::name(side) << (moves ? ", moving" : ", standing"));
        scene::Scene scene = free_sheet(method, dt);
        scene.gravity = gravity;
        scene::Motion motion;
        if (moves) motion = scene::Linear{velocity};
        scene.cloths[0].pins = {{scene::AtBox{dvec3(-9.0), dvec3(9.0)}, motion}};
        scene.keys = {lets_go(0, go)};
        test::Stepped stepped(side, scene);
        stepped.step(static_cast<int>(std::lround(time / dt)));
        const double fallen = time - go;
        const dvec3 way = (moves ? time : 0.0) * velocity + 0.5 * fallen * fallen * gravity;
        // Methods of the first order add half of a step's fall too much or too little in each.
        CHECK(off(stepped.state(), stepped.world(), way) < 0.6 * dt * 9.8 * fallen + 1e-4);
      }
}

TEST_CASE(
    "a step with keys is the same on the GPU and in the reference, under each method and in both models") {
  const auto context = test::context();
  test::Part part(3);
  for (const bool finite_elements : {false, true})
    for (const Method method : scene::methods) {
      if (finite_elements && method == Method::pbd) continue;
      if (part.leaves_out()) continue;
      INFO(scene::name(method) << (finite_elements ? ", finite elements" : ", springs"));
      scene::Scene scene = busy(method, finite_elements ? sheet : springs);
      scene.solver.tolerance = 1e-7;
      const reference::World plain = world_of(scene);
      scene.keys = all_keys(scene);
      const reference::World world = world_of(scene);
      const auto simulation = test::simulation(scene);
      reference::State expected = reference::at_rest(world), without = reference::at_rest(plain);
      double worst = 0.0;
      for (int n = 1; n <= 200; ++n) {
        reference::step(world, expected);
        reference::step(plain, without);
        simulation->step(1);
        if (n % 20 != 0) continue;
        const reference::State found = in_double(simulation->read_state(), static_cast<std::uint64_t>(n));
        worst = std::max(worst, reference::rms_distance(found.position, expected.position));
      }
      const double changed = reference::rms_distance(without.position, expected.position);
      INFO("off by " << worst << " m; without keys " << changed << " m");
      // Rounding, which this cloth's folds magnify little in so short a time, and what linear solves leave.
      // BDF2 also goes on with the rounding of the last step's way.
      CHECK(worst < (method == Method::bdf2 ? 3e-5 : 1e-5));
      CHECK(changed > 100 * worst);
    }
}

TEST_CASE("the reference's two methods agree on the motion under keys") {
  for (const bool finite_elements : {false, true}) {
    INFO((finite_elements ? "finite elements" : "springs"));
    scene::Scene scene = busy(Method::rk4, finite_elements ? sheet : springs);
    scene.colliders.clear();  // of which each step of a method meets another part
    scene.keys = all_keys(scene);
    std::erase_if(scene.keys, [](const scene::Key& of) { return of.of.starts_with("/colliders"); });
    const reference::World world = world_of(scene);
    const Result<reference::Trajectory> by_rk4 = reference::trajectory(world, {0.1}, 1e-4);
    REQUIRE(by_rk4);
    // Steps end at keyframes, between which RK4 keeps its order: over a jump a step of 0.1 ms errs by a sixth
    // of what the jump adds in it, a few 1e-6 m here in 0.1 s.
    CHECK(by_rk4->error.back() < 1e-5);
    // A step of 0.1 ms is a third of the time in which the springs' fastest vibration turns by a radian:
    // Esdirk, of third order, errs by some hundredths of that vibration's width of a few mm.
    reference::Follower esdirk(world, {reference::Pace::Method::esdirk, 1e-4, {}, 1e-10}, {});
    reference::State state = reference::at_rest(world);
    REQUIRE(esdirk.follow(state, 0.0, 0.1));
    CHECK(reference::rms_distance(state.position, by_rk4->states.back().position) < 1e-4);
  }
}

TEST_CASE("keys count from the start again after a reset, and from a kept state as before, to the bit") {
  const auto context = test::context();
  for (const Method method : test::tried_of(scene::methods)) {
    INFO(scene::name(method));
    scene::Scene scene = busy(method, springs);
    scene.keys = all_keys(scene);
    const auto simulation = test::simulation(scene), other = test::simulation(scene);
    simulation->kept().every = 30;
    simulation->step(200);
    const std::uint64_t end = hash(*simulation);
    for (int n = 0; n < 200; ++n) {
      other->step(1);
      (void)other->diagnose();
    }
    CHECK(hash(*other) == end);
    for (const std::uint64_t step : {90u, 60u}) {  // its pin lets go at step 80
      REQUIRE(simulation->go_to_kept(step, scene));
      CHECK(simulation->step_index() == step);
      simulation->step(static_cast<std::uint32_t>(200 - step));
      CHECK(hash(*simulation) == end);
    }
    simulation->reset();
    simulation->step(200);
    CHECK(hash(*simulation) == end);
    scene.keys.clear();
    REQUIRE(other->change(scene));
    const dvec3 before = other->read_state().position[0];
    other->step(1);
    CHECK(glm::distance(before, dvec3(other->read_state().position[0])) <
          0.01);  // it does not jump to its pin
  }
}

TEST_CASE("a scene whose keys have the values that it has anyway moves as without them, to the bit") {
  const auto context = test::context();
  for (const Method method : test::tried_of(scene::methods)) {
    INFO(scene::name(method));
    scene::Scene scene = busy(method, springs);
    const auto plain = test::simulation(scene);
    scene.keys = {key("/gravity", {0.0, 1.0}, {scene.gravity, scene.gravity}),
                  key("/cloths/0/material/bend", {0.01}, {dvec3(20, 0, 0)}),
                  key("/wind/gust", {0.0, 1.0}, {dvec3(0.2, 0, 0), dvec3(0.2, 0, 0)})};
    const auto keyed = test::simulation(scene);
    plain->step(64);
    keyed->step(64);
    CHECK(hash(*plain) == hash(*keyed));
  }
}
