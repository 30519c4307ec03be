// How far a step is from solved: against the step's solution in double precision, and who is told.
#include <cmath>
#include <cstdint>
#include <utility>

#include "server/model/extent.h"
#include "server/reference/reference.h"
#include "server/scene/document.h"
#include "server/scene/method.h"
#include "server/sim/convergence.h"
#include "tests/scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr double frame = 1.0 / 60;

/// A sheet of springs, 0.1 kg a vertex as the seed's, or of cotton, hung by two corners.
scene::Scene hung(int side, bool cotton, Method method, int iterations, double dt) {
  scene::Scene scene = test::sheet(side, side);
  scene::Cloth& cloth = scene.cloths[0];
  if (cotton) {
    cloth.mass = {scene::Mass::Kind::area_density, 0.1036};
    cloth.material = scene::Fem{};
  }
  cloth.pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{side - 1, 0}, {}}};
  scene.solver = {.method = method, .dt = dt, .iterations = iterations};
  return scene;
}

/// RMS distance over the free vertices [m] from where the simulation's next step ends to where it ends in
/// double precision, solved to rounding. The step is done, and measured.
double true_error(sim::Simulation& simulation, scene::Scene scene) {
  scene.solver.method = Method::implicit_euler;
  const reference::World world = *reference::make_world(scene, 0.0);
  const sim::State start = simulation.read_state();
  reference::State solved = reference::at_rest(world);
  solved.position.assign(start.position.begin(), start.position.end());
  solved.velocity.assign(start.velocity.begin(), start.velocity.end());
  solved.step = simulation.step_index();
  reference::step(world, solved);
  REQUIRE(solved.residual < 1e-6);  // else its end is no truth
  simulation.measure_step(simulation.step_index());
  simulation.step(1);
  const sim::State end = simulation.read_state();
  double squares = 0.0, free = 0.0;
  for (std::size_t i = 0; i < end.position.size(); ++i) {
    if (world.pinned(i)) continue;
    const glm::dvec3 left = glm::dvec3(end.position[i]) - solved.position[i];
    squares += glm::dot(left, left);
    free += 1.0;
  }
  return std::sqrt(squares / free);
}

/// The state of the scene after 1 s, each fourth step of which was measured, and what that found.
std::pair<sim::State, sim::Convergence> state_after_a_second(const scene::Scene& scene) {
  const auto simulation = test::simulation(scene);
  const auto steps = static_cast<std::uint64_t>(std::lround(1.0 / scene.solver.dt));
  for (std::uint64_t step = 0; step < steps; step += 4) {
    simulation->measure_step(step);
    simulation->step(4);
  }
  return {simulation->read_state(), simulation->convergence()};
}

/// RMS over all vertices [m].
double distance(const sim::State& a, const sim::State& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.position.size(); ++i) {
    const glm::dvec3 between = glm::dvec3(a.position[i]) - glm::dvec3(b.position[i]);
    squares += glm::dot(between, between);
  }
  return std::sqrt(squares / static_cast<double>(a.position.size()));
}

struct Case {
  bool cotton;
  Method method;
  int iterations;
  double dt;
};

}  // namespace

TEST_CASE("the error of a step is that against its solution in double precision, within a factor of two") {
  const auto context = test::context();
  test::Part part(2);
  for (const auto& [cotton, method, iterations, dt] :
       {Case{false, Method::pbd, 10, frame}, Case{false, Method::pbd, 3, 0.004},
        Case{false, Method::xpbd, 10, frame}, Case{false, Method::xpbd, 60, frame},
        Case{false, Method::xpbd, 4, 0.004}, Case{true, Method::xpbd, 10, frame},
        Case{false, Method::vbd, 10, frame}, Case{false, Method::vbd, 60, frame},
        Case{true, Method::vbd, 10, frame}, Case{true, Method::vbd, 5, 0.004},
        Case{false, Method::implicit_euler, 1, frame}, Case{true, Method::implicit_euler, 1, frame},
        Case{true, Method::implicit_euler, 1, 0.004}}) {
    if (part.leaves_out()) continue;
    const scene::Scene scene = hung(13, cotton, method, iterations, dt);
    const auto simulation = test::simulation(scene);
    for (const int steps : {10, 20}) {  // while it falls, and when it swings or has stretched
      simulation->step(steps);
      const double truth = true_error(*simulation, scene), found = simulation->convergence().error;
      INFO((cotton ? "cotton, " : "springs, ")
           << scene::name(method) << ", " << iterations << " iterations, dt " << dt << ", step "
           << simulation->step_index() << ": " << 1000 * found << " mm, in truth " << 1000 * truth);
      CHECK(simulation->convergence().step + 1 == simulation->step_index());
      CHECK(found < 2.0 * truth);
      CHECK(found > 0.5 * truth);
    }
  }
}

TEST_CASE("cotton that few sweeps stretch is told, with what helps that method; solved cotton is not") {
  const auto context = test::context();
  for (const Method method : {Method::xpbd, Method::vbd}) {
    INFO(scene::name(method));
    const scene::Scene few = hung(33, true, method, 10, frame);
    const auto simulation = test::simulation(few);
    simulation->step(20);
    simulation->measure_step(20);
    simulation->step(1);
    CHECK(simulation->convergence().often_unsolved());
    CHECK(simulation->convergence().residual > 0.5);
    const std::string told = sim::in_words(simulation->convergence(), few);
    CHECK(told.find("more iterations, a smaller dt, or the method implicit_euler") != std::string::npos);
  }
  const scene::Scene sheet = hung(33, false, Method::pbd, 10, frame);
  const auto soft = test::simulation(sheet);
  soft->measure_step(29);
  soft->step(30);
  CHECK(soft->convergence().often_unsolved());
  CHECK(sim::in_words(soft->convergence(), sheet).find("xpbd") != std::string::npos);

  const scene::Scene solved = hung(33, true, Method::implicit_euler, 20, frame);
  const auto simulation = test::simulation(solved);
  simulation->step(20);
  simulation->measure_step(20);
  simulation->step(1);
  INFO(1000 * simulation->convergence().largest_error << " mm");
  CHECK(simulation->convergence().measured >= 2);
  CHECK(simulation->convergence().unsolved_steps == 0);
}

TEST_CASE(
    "under Newton's method errors add up: cotton that is told is off after a second, cotton that is not is "
    "right") {
  const auto context = test::context();
  test::Part part(2);
  for (const Method method : {Method::implicit_euler, Method::bdf2}) {
    if (part.leaves_out()) continue;
    scene::Scene exact = hung(25, true, method, 30, frame);
    exact.solver.tolerance = 1e-4;
    const sim::State truth = state_after_a_second(exact).first;
    for (const int iterations : {1, 20}) {
      scene::Scene scene = exact;
      scene.solver.iterations = iterations;
      scene.solver.tolerance = 0.05;
      const auto [state, convergence] = state_after_a_second(scene);
      const double off = distance(state, truth);
      INFO(scene::name(method) << ", " << iterations << " Newton steps: " << 1000 * off << " mm off, "
                               << convergence.unsolved_steps << " of " << convergence.measured
                               << " steps unsolved, the last by " << 1000 * convergence.error << " of "
                               << 1000 * convergence.tolerance << " mm");
      CHECK(convergence.often_unsolved() == (iterations == 1));
      // of the sheet's 1 m a hundredth is allowed; one Newton step loses 196 mm, or 130
      if (iterations == 1)
        CHECK(off > 0.05);
      else
        CHECK(off < 0.02);
    }
  }
}

TEST_CASE("what is allowed in a step is 1 % of the extent after a second, and under sweeps 1/240 of it") {
  const auto context = test::context();
  for (const double dt : {frame, 0.004})
    for (const Method method : {Method::implicit_euler, Method::bdf2, Method::xpbd}) {
      const auto simulation = test::simulation(hung(9, false, method, 2, dt));
      simulation->step(9);
      REQUIRE(simulation->convergence().measured == 1);
      const double extent = model::largest_extent(simulation->model());
      INFO(scene::name(method) << ", dt " << dt);
      CHECK(simulation->convergence().tolerance ==
            Approx(extent * (method == Method::xpbd ? 1.0 / 240 : 0.02 * dt)));
    }
}

TEST_CASE(
    "Newton steps end by themselves where a step is solved, and go on where a smaller tolerance asks it") {
  const auto context = test::context();
  const auto newton_steps = [](const scene::Scene& scene) {
    const auto simulation = test::simulation(scene);
    simulation->measure_convergence(false);
    simulation->step(60);
    return static_cast<double>(simulation->solver_work().newton_steps) / 60;
  };
  scene::Scene scene = hung(25, true, Method::implicit_euler, 20, frame);
  scene.solver.tolerance = 0.05;
  const double rough = newton_steps(scene);
  scene.solver.tolerance = 1e-3;
  const double fine = newton_steps(scene);
  INFO(rough << " Newton steps a step, with the small tolerance " << fine);
  CHECK(rough > 2);  // cotton that falls into folds is not solved by one
  CHECK(rough < 10);
  CHECK(fine > 1.2 * rough);
}

TEST_CASE("presets that sweep are solved as they ship, and the seed under sweeps of its own dt") {
  const auto context = test::context();
  for (const char* preset : {"funnel", "skirt", "seed"}) {
    scene::Scene scene = scene::load_preset(preset)->scene;
    for (const Method method : scene::iterates(scene.solver.method)
                                   ? std::vector<Method>{scene.solver.method}
                                   : std::vector<Method>{Method::xpbd, Method::vbd, Method::pbd}) {
      scene.solver.method = method;
      const auto simulation = test::simulation(scene);
      simulation->measure_step(19);
      simulation->step(20);
      INFO(preset << " under " << scene::name(method) << ": "
                  << 1000 * simulation->convergence().largest_error << " mm of "
                  << 1000 * simulation->convergence().tolerance);
      CHECK(simulation->convergence().measured == 2);
      CHECK(simulation->convergence().unsolved_steps == 0);
    }
  }
}

TEST_CASE("to measure how far a step is from solved changes no bit of the run") {
  const auto context = test::context();
  for (const Method method : {Method::pbd, Method::xpbd, Method::vbd, Method::implicit_euler}) {
    INFO(scene::name(method));
    scene::Scene scene = test::seed();
    scene.solver.method = method;
    scene.solver.dt = 0.004;
    scene.solver.iterations = method == Method::implicit_euler ? 1 : 4;
    const auto measured = test::simulation(scene), never = test::simulation(scene);
    never->measure_convergence(false);
    for (int step = 0; step < 20; ++step) {
      measured->measure_step(step);
      measured->step(1);
      never->step(1);
    }
    CHECK(measured->convergence().measured == 20);
    CHECK(never->convergence().measured == 0);
    CHECK(measured->dispatches() == never->dispatches());
    CHECK(measured->solver_work().linear_iterations == never->solver_work().linear_iterations);
    CHECK(sim::state_hash(measured->read_state()) == sim::state_hash(never->read_state()));
  }
}

TEST_CASE("steps are measured seldom enough that it takes a small part of them") {
  const auto context = test::context();
  scene::Scene scene = hung(9, false, Method::xpbd, 10, 0.004);
  const auto simulation = test::simulation(scene);
  simulation->step(9);
  CHECK(simulation->convergence().measured == 1);
  CHECK(simulation->convergence().step == 8);
  // The next comes after three times as many steps.
  simulation->step(26);
  CHECK(simulation->convergence().measured == 1);
  simulation->step(1);
  CHECK(simulation->convergence().measured == 2);
  // The least that it takes, 4 Newton steps, is worth 32 sweeps, more than 4 steps with the one done again:
  // the one after that comes no sooner than after 80.
  simulation->step(79);
  CHECK(simulation->convergence().measured == 2);
  scene.solver.iterations = 20;
  REQUIRE(simulation->change(scene));
  CHECK(simulation->convergence().measured == 0);
  simulation->step(9);
  CHECK(simulation->convergence().measured == 1);
}
