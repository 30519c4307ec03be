// The largest stable dt of each method, found by bisection on the total energy, in the reference and on the
// GPU, against theory.
#include <algorithm>
#include <cmath>

#include "server/model/stability.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// Energy of the scene's vibrations [J]: the largest kinetic energy of a resolved motion.
double energy_scale(scene::Scene scene, double omega) {
  scene.solver.method = Method::rk4;
  scene.solver.dt = 0.2 / omega;
  Stepped stepped(Side::reference, scene);
  double largest = 0.0;
  for (int n = 0; n < 200; ++n) {
    stepped.step(2);
    largest = std::max(largest, stepped.energy().kinetic);
  }
  return largest;
}

/// True if the total energy does not grow for `steps` steps of dt. Near its limit a stable method may swing
/// by far more than the scene's own energy (symplectic Euler and Verlet by 1/(1 - (dt/limit)^2)); beyond the
/// limit it grows without end.
bool holds(Stepped& stepped, double dt, int steps, double scale) {
  stepped.restart(dt);
  const double start = stepped.energy().total();
  for (int done = 0; done < steps; done += 250) {
    stepped.step(250);
    // a value that is not finite counts as growth
    if (!(stepped.energy().total() - start < 1e4 * scale)) return false;
  }
  return true;
}

/// The largest stable dt to 0.3 %, found between half and twice `expected`.
double largest_stable(Stepped& stepped, double expected, double scale) {
  constexpr int steps = 4000;
  double stable = 0.5 * expected, unstable = 2.0 * expected;
  CHECK(holds(stepped, stable, steps, scale));
  CHECK_FALSE(holds(stepped, unstable, steps, scale));
  while (unstable / stable > 1.003) {
    const double dt = std::sqrt(stable * unstable);
    (holds(stepped, dt, steps, scale) ? stable : unstable) = dt;
  }
  return std::sqrt(stable * unstable);
}

/// Checks the limit by bisection, and steps for longer just below and above it, in the reference and on the
/// GPU.
void check_limit(const scene::Scene& scene, double expected, double omega) {
  const double scale = energy_scale(scene, omega);
  for (const Side side : sides) {
    Stepped stepped(side, scene);
    const double found = largest_stable(stepped, expected, scale);
    INFO(scene::name(scene.solver.method) << " on " << name(side) << ": " << found << " s, theory "
                                          << expected << " s, ratio " << found / expected);
    CHECK(std::abs(found / expected - 1.0) < 0.03);  // of which the bisection may use 0.3 %
    CHECK(holds(stepped, 0.99 * expected, 10000, scale));
    CHECK_FALSE(holds(stepped, 1.015 * expected, 10000, scale));
  }
}

/// Amplitude [m] so small that the spring is linear until its growth is visible.
constexpr double small = 1e-3;

/// The closed form of a method's limit, in 1/omega, at damping ratio z (shaders/README.md).
double limit_of(Method method, double z) {
  if (method == Method::explicit_euler) return 2 * z;
  if (method == Method::symplectic_euler) return 2 * (std::sqrt(1 + z * z) - z);
  if (method == Method::verlet)
    return 2 * (std::sqrt(1 + 4 * z * z) - 2 * z);  // its damping lags twice as much
  return z == 0.0 ? 2.828 : z == 0.1 ? 2.95 : z == 0.5 ? 2.62 : 2.79;
}

/// A grid of equal stiffness [N/m] and mass [kg] hung from its top edge; gravity in its plane stretches it by
/// 1e-4.
scene::Scene hanging_grid(Method method, double k, double mass) {
  scene::Scene scene = bare_scene(method, 1e-3);
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{9, 7, 0.8, 0.6};
  cloth.mass = {scene::Mass::Kind::per_vertex, mass};
  cloth.material = scene::Springs{k, k, k, 0.0};
  cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
  scene.cloths = {cloth};
  scene.gravity = {0.0, 0.0, 1e-5 * k / mass};
  return scene;
}

}  // namespace

TEST_CASE(
    "on one undamped spring the limit is 2/omega for symplectic Euler and Verlet, 2.828/omega for RK4") {
  const auto context = test::context();
  for (const Method method : {Method::symplectic_euler, Method::verlet, Method::rk4})
    check_limit(one_spring(method, 0.1, 0.0, small), limit_of(method, 0.0) / spring_omega, spring_omega);
}

TEST_CASE("damping moves one spring's limit as each method's closed form says") {
  const auto context = test::context();
  for (const double z : {0.1, 0.5, 1.0}) {
    const double damping = 2 * z * spring_omega;
    for (const Method method :
         {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
      if (method == Method::explicit_euler && z < 0.5)
        continue;  // grows too slowly beyond its limit to be found
      INFO("z = " << z);
      check_limit(one_spring(method, 0.1, damping, small), limit_of(method, z) / spring_omega, spring_omega);
    }
  }
}

TEST_CASE("on a chain the limit is that of its fastest vibration, 2 sqrt(k/m) sin((2N - 1) pi / (4N + 2))") {
  const auto context = test::context();
  constexpr int links = 10;
  const double k = 400.0, mass = 0.01;
  const double omega =
      2 * std::sqrt(k / mass) * std::sin((2 * links - 1) * std::acos(-1.0) / (4 * links + 2));
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    scene::Scene scene = chain(method, 1e-3, links, k, mass);
    scene.gravity = {0.0, 0.0, 1.0};
    double z = 0.0;
    if (method == Method::explicit_euler) scene.cloths[0].springs().damping = 2 * (z = 0.5) * k / omega;
    check_limit(scene, limit_of(method, z) / omega, omega);
  }
}

TEST_CASE("on a grid the limit is that of its fastest vibration, found by power iteration") {
  const auto context = test::context();
  const double k = 100.0, mass = 0.001;
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    scene::Scene scene = hanging_grid(method, k, mass);
    const double omega = model::omega_max(*model::build(scene), scene);
    double z = 0.0;
    if (method == Method::explicit_euler) scene.cloths[0].springs().damping = 2 * (z = 0.5) * k / omega;
    INFO("omega " << omega << " /s, in sqrt(k/m) " << omega / std::sqrt(k / mass));
    check_limit(scene, limit_of(method, z) / omega, omega);
    CHECK(model::dt_limit(*model::build(scene), scene) == Approx(limit_of(method, z) / omega).epsilon(0.002));
  }
}

TEST_CASE(
    "on a sheet of finite elements the limit is that of its fastest vibration, for every explicit method") {
  const auto context = test::context();
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    scene::Scene scene = sheet_of_elements(method, 1e-3, 7);
    scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
    // In its plane, and so weak that the sheet stretches by 1e-4: its weight is 0.2 kg/m^2 x 0.25 m.
    scene.gravity = {0.0, 0.0, 1e-4 * 40.0 / (0.2 * 0.25)};
    const double omega = model::omega_max(*model::build(scene), scene);
    // Stiffness-proportional: a vibration's damping ratio is damping x omega / 2.
    const double z = 0.5;
    if (method == Method::explicit_euler)
      std::get<scene::Fem>(scene.cloths[0].material).damping = 2 * z / omega;
    const double limit = limit_of(method, method == Method::explicit_euler ? z : 0.0) / omega;
    INFO("omega " << omega << " /s");
    check_limit(scene, limit, omega);
    CHECK(model::dt_limit(*model::build(scene), scene) == Approx(limit).epsilon(0.002));
  }
}

TEST_CASE("a sheet's stiffness-proportional damping moves its limit as each method's closed form says") {
  const auto context = test::context();
  for (const Method method : {Method::symplectic_euler, Method::verlet, Method::rk4}) {
    scene::Scene scene = sheet_of_elements(method, 1e-3, 5);
    scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
    scene.gravity = {0.0, 0.0, 1e-4 * 40.0 / (0.2 * 0.25)};
    const double omega = model::omega_max(*model::build(scene), scene), z = 0.5;
    std::get<scene::Fem>(scene.cloths[0].material).damping = 2 * z / omega;
    INFO("omega " << omega << " /s");
    check_limit(scene, limit_of(method, z) / omega, omega);
    CHECK(model::dt_limit(*model::build(scene), scene) == Approx(limit_of(method, z) / omega).epsilon(0.002));
  }
}
