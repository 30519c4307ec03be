// Hands on the cloth (server/sim/hands.h): they lift it under every method, and nothing that they do blows it
// up.
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <random>

#include "server/model/hold.h"
#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/sim/guarded_run.h"
#include "server/sim/hands.h"
#include "tests/methods.h"
#include "tests/physics/stage.h"

using namespace clothlab;
using glm::dvec3;
using scene::Method;
using Verdict = sim::GuardedRun::Verdict;

namespace {

/// Vertices along each side: half of the seed's, for how fine it is is not what is tested here.
constexpr std::uint32_t side = 13;
constexpr std::uint32_t middle_of_seed = side * (side / 2) + side / 2;
constexpr std::uint32_t lower_edge_of_seed = side * (side - 1) + side / 2;
constexpr std::uint32_t near_the_upper_edge = side + 7;

std::shared_ptr<const model::Hold> hold_on(sim::Simulation& simulation, std::uint32_t vertex) {
  return std::make_shared<const model::Hold>(
      model::hold_on(simulation.model(), simulation.scene(), vertex, simulation.read_state().position));
}

/// The seed, coarser, with one method, at a step that it holds: 80 % of its limit, or as long as a frame
/// where there is none.
scene::Scene seed_under(Method method) {
  scene::Scene scene = test::seed();
  scene::Cloth& cloth = scene.cloths[0];
  cloth.mesh = scene::Grid{side, side, 1.0, 1.0};
  cloth.pins = {{scene::AtCorner{0, 0}, cloth.pins[0].motion},
                {scene::AtCorner{side - 1, 0}, cloth.pins[1].motion}};
  scene.colliders.clear();
  scene.solver.method = method;
  scene.solver.iterations = scene::sweeps(method) ? 10 : 4;
  const double limit = model::dt_limit(*model::build(scene), scene);
  scene.solver.dt = std::isinf(limit) ? (method == Method::vbd ? 0.004 : 0.008) : 0.8 * limit;
  return scene;
}

/// A simulation that is judged as in a session.
struct Run {
  std::unique_ptr<sim::Simulation> simulation;
  sim::GuardedRun guard;
  explicit Run(const scene::Scene& scene) : simulation(test::simulation(scene)), guard(*simulation) {
    guard.start(model::dt_limit(simulation->model(), scene));
  }
  void pull(const std::vector<sim::Hand>& hands) {
    REQUIRE(simulation->set_hands(hands));
    double force = 0.0, reach = 0.0;
    for (const sim::Hand& hand : hands) {
      force += hand.hold->force;
      reach = std::max(reach, hand.hold->reach);
    }
    guard.set_hands(force, reach);
  }
  /// False: it has blown up.
  bool go(double seconds) {
    const double until = simulation->time() + seconds;
    while (simulation->time() < until) {
      simulation->step(static_cast<std::uint32_t>(
          std::ceil(std::min(1.0 / 60, until - simulation->time()) / simulation->scene().solver.dt)));
      if (guard.judge_now() == Verdict::blown_up) return false;
    }
    return true;
  }
  dvec3 at(std::uint32_t vertex) const { return simulation->read_state().position[vertex]; }
};

}  // namespace

TEST_CASE("a hand lifts the seed's hanging cloth: its vertex comes near the target, under every method") {
  const auto context = test::context();
  for (const Method method : test::tried_of(scene::methods)) {
    Run run(seed_under(method));
    INFO(scene::name(method) << ", dt = " << run.simulation->scene().solver.dt);
    REQUIRE(run.go(1.0));
    const dvec3 start = run.at(lower_edge_of_seed), target{start.x, 1.3, 0.6};
    run.pull({{hold_on(*run.simulation, lower_edge_of_seed), target}});
    REQUIRE(run.go(2.0));
    // Hanging from one hand it would be 2 % of its diagonal too low; the pins swing and pull, by several
    // times that.
    const double size = std::sqrt(2.0);
    CHECK(glm::distance(run.at(lower_edge_of_seed), target) < 0.1 * size);
    CHECK(run.at(lower_edge_of_seed).y > start.y + 0.5);
    run.pull({});
    REQUIRE(run.go(0.4));
    CHECK(glm::distance(run.at(lower_edge_of_seed), target) > 0.2);
  }
}

TEST_CASE("two hands that tear the cloth about at random for 2 s never blow it up, under every method") {
  const auto context = test::context();
  for (const Method method : test::tried_of(scene::methods)) {
    Run run(seed_under(method));
    INFO(scene::name(method) << ", dt = " << run.simulation->scene().solver.dt);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anywhere(-4.0, 4.0);
    const auto first = hold_on(*run.simulation, middle_of_seed),
               second = hold_on(*run.simulation, near_the_upper_edge);
    const auto there = [&] { return dvec3(anywhere(random), 1.0 + anywhere(random), anywhere(random)); };
    bool holds = true;
    for (int jump = 0; jump < 60 && holds; ++jump) {
      run.pull({{first, there()}, {second, there()}});
      holds = run.go(1.0 / 30);
    }
    CHECK(holds);
    run.pull({});
    CHECK(run.go(0.5));
  }
}

TEST_CASE("a hold does not shorten the longest stable step") {
  const auto context = test::context();
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    // A sheet that hardly moves: a step beyond its limit would grow from rounding to a blow-up within the
    // run.
    scene::Scene scene = test::sheet(9, 9);
    scene.gravity = dvec3(0.0);
    scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}},
                            {scene::AtEdge{scene::AtEdge::Line::row, 8}, {}}};
    scene.solver.method = method;
    scene.solver.dt = 0.99 * model::dt_limit(*model::build(scene), scene);
    Run run(scene);
    INFO(scene::name(method) << ", dt = " << scene.solver.dt);
    const dvec3 start = run.at(40);
    run.pull({{hold_on(*run.simulation, 40), start + dvec3(0.0, 1e-4, 0.0)}});
    run.simulation->step(4000);
    const sim::Diagnostics after = run.simulation->diagnose();
    CHECK(after.finite);
    CHECK(glm::distance(run.at(40), start) < 3e-4);
    CHECK(after.max_speed < 0.1);
  }
}

TEST_CASE("nothing is left of a hand that has let go: the masses are those before, and so is a step") {
  const auto context = test::context();
  for (const Method method : test::tried_of(scene::methods)) {
    INFO(scene::name(method));
    const auto held = test::simulation(seed_under(method)), never = test::simulation(seed_under(method));
    REQUIRE(held->set_hands({{hold_on(*held, middle_of_seed), dvec3(0.0, 2.0, 0.0)}}));
    held->step(40);
    REQUIRE(held->set_hands({}));
    CHECK(sim::state_hash(held->read_state()) != sim::state_hash(never->read_state()));
    held->reset();
    held->step(20);
    never->step(20);
    CHECK(sim::state_hash(held->read_state()) == sim::state_hash(never->read_state()));
    // The GPU sums energies with the masses that lie there.
    REQUIRE(held->set_hands({{hold_on(*held, middle_of_seed), dvec3(0.0, 2.0, 0.0)}}));
    held->step(30);
    double kinetic = 0.0;
    const sim::State swinging = held->read_state();
    for (std::uint32_t i = 0; i < held->model().vertex_count(); ++i)
      if (held->model().pin_motion[i] == model::not_pinned)
        kinetic +=
            0.5 * held->model().mass[i] * glm::dot(dvec3(swinging.velocity[i]), dvec3(swinging.velocity[i]));
    CHECK(held->diagnose().kinetic == Approx(kinetic).epsilon(1e-4));
    // Without a reset: from a state that was held, the same steps follow as from that state brought in from
    // outside.
    REQUIRE(held->set_hands({{hold_on(*held, middle_of_seed), dvec3(0.0, 2.0, 0.0)}}));
    held->step(10);
    REQUIRE(held->set_hands({}));
    const sim::State state = held->read_state();
    held->restore(state, held->time(), held->step_index());
    never->restore(state, held->time(), held->step_index());
    held->step(10);
    never->step(10);
    CHECK(sim::state_hash(held->read_state()) == sim::state_hash(never->read_state()));
  }
}

TEST_CASE("a step under way that is given up leaves no trace of the hand that began it") {
  const auto context = test::context();
  const auto held = test::simulation(seed_under(Method::implicit_euler));
  const sim::State before = held->read_state();
  REQUIRE(held->set_hands({{hold_on(*held, middle_of_seed), dvec3(0.0, 2.0, 0.0)}}));
  held->set_steps_to_do(1);
  sim::Pace pace;
  pace.most_places = 3;
  held->resume(pace);
  REQUIRE(held->steps_to_do() == 1);  // it stopped on its way
  CHECK(sim::state_hash(held->read_state()) == sim::state_hash(before));
  const double kinetic = held->diagnose().kinetic;
  CHECK(kinetic == 0.0);
  REQUIRE(held->set_hands({}));
  CHECK(sim::state_hash(held->read_state()) == sim::state_hash(before));
  const auto never = test::simulation(seed_under(Method::implicit_euler));
  held->step(5);
  never->step(5);
  CHECK(sim::state_hash(held->read_state()) == sim::state_hash(never->read_state()));
}

TEST_CASE("a hand holds under a strain limit and with contact between surfaces") {
  const auto context = test::context();
  for (const Method method : {Method::symplectic_euler, Method::implicit_euler, Method::xpbd}) {
    if (method == Method::implicit_euler && !test::thorough()) continue;
    scene::Scene scene = seed_under(method);
    scene.cloths[0].springs().strain_limit = 0.1;
    scene.self_collision = scene::SelfCollision{0.01, 0.2, scene::ContactKind::surface};
    if (scene.solver.dt > 0.004) scene.solver.dt = 0.004;
    Run run(scene);
    INFO(scene::name(method));
    REQUIRE(run.go(0.6));
    const dvec3 start = run.at(lower_edge_of_seed), target = start + dvec3(0.0, 0.3, 0.1);
    run.pull({{hold_on(*run.simulation, lower_edge_of_seed), target}});
    REQUIRE(run.go(1.0));
    CHECK(glm::distance(run.at(lower_edge_of_seed), target) < 0.15);
    CHECK(run.simulation->diagnose().max_strain < 0.5);
  }
}

TEST_CASE("a hold spreads along the cloth, and leaves pinned vertices out") {
  constexpr std::uint32_t middle = 12 * 25 + 12;
  const model::Model model = *model::build(test::seed());
  std::vector<glm::vec3> places(model.rest_position.begin(), model.rest_position.end());
  const model::Hold inside = model::hold_on(model, test::seed(), middle, places);
  CHECK(inside.vertices.size() == 13);
  CHECK(inside.vertices.front().vertex == middle);
  double stiffness = 0.0;
  for (const model::Hold::Vertex& held : inside.vertices) stiffness += held.stiffness;
  // The whole cloth hangs from it with a sag of 2 % of its diagonal.
  CHECK(stiffness == Approx(625 * 0.1 * 9.8 / (0.02 * std::sqrt(2.0))));
  for (const model::Hold::Vertex& held : model::hold_on(model, test::seed(), 1, places).vertices)
    CHECK(held.vertex != 0);
}
