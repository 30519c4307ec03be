// The order of every method: of the reference over three halvings of dt, of the GPU as far as float32 allows.
// What float32 adds is measured by itself: the distance between the two at the same dt.
#include "server/scene/suited.h"
#include "tests/methods.h"
#include "tests/physics/orders.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// How a method is measured on a scene, and the result that is required.
struct Plan {
  Method method;
  int coarsest;      ///< steps at the largest dt
  int gpu_halvings;  ///< halvings of dt on the GPU before float32 hides the method's error; -1: it always
                     ///< does
  double floor;      ///< the most that float32 may add [m]; for implicit Euler and BDF2 with their solver's
                     ///< tolerance
};

constexpr int halvings = 3;
constexpr double tolerance = 0.15;  // of the order: at these dt the next order is still seen
/// The method's error is seen while it is 4 times what float32 adds: such an independent error adds 3 % to
/// it, 0.05 to the order.
constexpr double seen = 4.0;

double mean_order(const Rung& first, const Rung& last) {
  return std::log2(first.error / last.error) / std::log2(static_cast<double>(last.steps) / first.steps);
}

std::string text(const std::vector<Rung>& rungs) {
  std::string lines;
  for (const Rung& rung : rungs)
    lines += "\n  " + std::to_string(rung.steps) + " steps: error " + std::to_string(rung.error * 1e6) +
             " um, of float32 " + std::to_string(rung.floor * 1e6) + " um";
  return lines;
}

/// Of the plans, those of the methods that are tried.
std::vector<Plan> tried_plans(std::vector<Plan> plans) {
  std::erase_if(plans, [](const Plan& plan) { return !tried(plan.method); });
  return plans;
}

/// Checks every planned method on `scene` against the truth at `time` [s].
void check_orders(const SceneOf& scene, double time, int truth_steps, const std::vector<Plan>& plans) {
  const auto context = test::context();
  const Truth exact = truth(scene, time, truth_steps);
  for (const Plan& plan : plans) {
    INFO(scene::name(plan.method));
    const Ladder ladder = climb(plan.method, scene, time, plan.coarsest, halvings + 1, exact);
    {
      INFO("reference:" << text(ladder.reference));
      CHECK(exact.error < 0.05 * ladder.reference.back().error);  // 0.02 of the order
      CHECK(std::abs(mean_order(ladder.reference.front(), ladder.reference.back()) -
                     scene::facts(plan.method).order) < tolerance);
    }
    INFO("GPU:" << text(ladder.gpu));
    int visible = 0;
    while (visible <= halvings && ladder.gpu[static_cast<std::size_t>(visible)].error >
                                      seen * ladder.gpu[static_cast<std::size_t>(visible)].floor)
      ++visible;
    CHECK(visible - 1 >= plan.gpu_halvings);
    if (visible > 1) {
      const double order = mean_order(ladder.gpu.front(), ladder.gpu[static_cast<std::size_t>(visible - 1)]);
      CHECK(std::abs(order - scene::facts(plan.method).order) < tolerance);
    }
    for (const Rung& rung : ladder.gpu) CHECK(rung.floor < plan.floor);
  }
}

scene::Scene precise(scene::Scene scene) {
  scene.solver.tolerance = 1e-7;  // of implicit Euler's linear solver: as small as float32 allows
  return scene;
}

}  // namespace

TEST_CASE("one spring: every method has its order, in float32 down to a micrometre") {
  const std::vector<Plan> plans{
      {Method::explicit_euler, 200, 3, 2e-6}, {Method::symplectic_euler, 100, 3, 2e-6},
      {Method::verlet, 20, 3, 1e-6},          {Method::rk4, 12, 2, 1e-6},
      {Method::implicit_euler, 100, 3, 5e-6}, {Method::pbd, 100, 3, 5e-6},
      {Method::xpbd, 100, 3, 5e-6},           {Method::vbd, 100, 3, 5e-6},
      {Method::bdf2, 100, 2, 5e-6},
  };
  CHECK(plans.size() == scene::methods.size());
  check_orders([](Method method, double dt) { return precise(one_spring(method, dt)); }, 2.0, 4000, plans);
}

TEST_CASE("one damped spring: every method has its order, in float32 down to a micrometre") {
  check_orders([](Method method, double dt) { return precise(one_spring(method, dt, 1.6)); }, 1.75, 4000,
               tried_plans({{Method::explicit_euler, 200, 3, 2e-6},
                            {Method::symplectic_euler, 100, 3, 2e-6},
                            {Method::verlet, 20, 3, 1e-6},
                            {Method::rk4, 20, 1, 1e-6},
                            {Method::implicit_euler, 100, 3, 5e-6},
                            {Method::pbd, 100, 3, 5e-6},
                            {Method::xpbd, 100, 3, 5e-6},
                            {Method::vbd, 100, 3, 5e-6},
                            {Method::bdf2, 100, 2, 5e-6}}));
}

// Implicit Euler and BDF2 leave 1e-7 of a momentum of 4 m/s unsolved per step, for up to 800 steps in 1 s: at
// most 3e-4 m.
TEST_CASE("a pendulum: every method has its order, in float32 down to some micrometres") {
  check_orders([](Method method, double dt) { return precise(pendulum(method, dt, 60.0, 100.0)); }, 1.0, 4000,
               {{Method::explicit_euler, 400, 3, 3e-6},
                {Method::symplectic_euler, 200, 3, 3e-6},
                {Method::verlet, 40, 3, 2e-6},
                {Method::rk4, 15, 2, 1e-6},
                {Method::implicit_euler, 100, 3, 1e-4},
                {Method::xpbd, 100, 3, 1e-5},
                {Method::vbd, 100, 3, 1e-5},
                {Method::bdf2, 100, 0, 3e-4}});
}

TEST_CASE(
    "a swinging cloth: symplectic Euler, Verlet and RK4 have their orders, in float32 down to some "
    "micrometres") {
  // dt of 0.6 u, RK4 0.83 u: 0.95 of their limits. RK4 is at float32's floor with its second dt.
  check_orders(swinging_cloth, 0.3, 3000,
               {{Method::symplectic_euler, 413, 3, 1e-5},
                {Method::verlet, 413, 1, 1e-5},
                {Method::rk4, 300, 0, 1e-5}});
}

TEST_CASE("a cloth that begins to swing: explicit and implicit Euler, XPBD and VBD have order 1") {
  // Explicit Euler's undamped vibrations grow by exp(omega^2 dt t / 2): an early time and a small dt keep
  // those of rounding small. Even so float32 leaves one halving or none. Implicit Euler damps vibrations by
  // as much: the same early time shows the order of the motion rather than the loss of vibrations.
  const SceneOf scene = [](Method method, double dt) { return precise(swinging_cloth(method, dt)); };
  check_orders(scene, 0.03, 600,
               {{Method::explicit_euler, 620, 0, 1e-5},
                {Method::implicit_euler, 16, 3, 1e-5},
                {Method::xpbd, 24, 3, 1e-5},
                {Method::vbd, 24, 3, 1e-5}});
}

TEST_CASE("a sheet of finite elements hung by two corners: every method has its order") {
  // Verlet and RK4 are at float32's floor of some 0.05 um with their longest steps. Implicit Euler leaves
  // 1e-7 of a momentum of 1 m/s unsolved in each of up to 800 steps. Sweeps must converge for the order to
  // show: an element's three strains and its curvature meet in each vertex.
  const SceneOf scene = [](Method method, double dt) {
    scene::Scene sheet = precise(sheet_of_elements(method, dt, 5, 3e-4));
    sheet.gravity = {0.0, -9.81, 0.0};
    sheet.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{4, 0}, {}}};
    sheet.solver.iterations = 40;
    return sheet;
  };
  const std::vector<Plan> plans{{Method::explicit_euler, 300, 3, 1e-5},
                                {Method::symplectic_euler, 150, 3, 1e-5},
                                {Method::verlet, 150, -1, 1e-6},
                                {Method::rk4, 75, -1, 1e-6},
                                {Method::implicit_euler, 50, 2, 2e-5},
                                {Method::xpbd, 100, 2, 1e-5},
                                {Method::vbd, 100, 2, 1e-5},
                                {Method::bdf2, 50, 0, 2e-5}};
  CHECK(plans.size() == scene::suited_methods(scene(Method::verlet, 1e-4), {})->size());
  check_orders(scene, 0.05, 1000, tried_plans(plans));
}

TEST_CASE(
    "a sheet as stiff as cotton: implicit Euler has order 1 and BDF2 order 2, however short the steps") {
  // Stretch of 4 kN/m on 0.1 kg/m^2 lets explicit steps be 20 us at most. A solver that takes stiffness times
  // the rounding of places for the precision to be had would leave gravity unsolved at the shorter steps.
  const SceneOf scene = [](Method method, double dt) {
    scene::Scene sheet = precise(sheet_of_elements(method, dt, 9));
    sheet.gravity = {0.0, -9.81, 0.0};
    sheet.cloths[0].mesh = scene::Grid{9, 9, 0.5, 0.5};
    sheet.cloths[0].mass = {scene::Mass::Kind::area_density, 0.1};
    sheet.cloths[0].material =
        scene::Fem{2400.0, 3800.0, 0.3, 97.0, {8e-6, 12e-6, std::nullopt}, 1e-4, 0.0, std::nullopt};
    sheet.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
    sheet.solver.iterations = 8;
    return sheet;
  };
  check_orders(scene, 0.1, 7000, {{Method::implicit_euler, 50, 3, 2e-5}, {Method::bdf2, 100, 1, 2e-5}});
}

TEST_CASE("a damped swinging cloth: explicit Euler has order 1, in float32 too") {
  // With damping of 0.3 u times the stiffness, explicit Euler is stable below 0.3 u.
  const SceneOf scene = [](Method method, double dt) {
    scene::Scene damped = swinging_cloth(method, dt);
    damped.cloths[0].springs().damping = 0.3 * cloth_unit * 100.0;
    return damped;
  };
  check_orders(scene, 0.15, 2000, {{Method::explicit_euler, 1240, 3, 2e-5}});
}
