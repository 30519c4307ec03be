// The step limit: bound and sharp value against closed forms, and each method's own growth on both sides of
// the limit.
#include "server/model/stability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "server/scene/document.h"
#include "tests/catch.h"

using namespace clothlab;
using scene::Method;

namespace {

struct Sheet {
  scene::Scene scene;
  model::Model model;
};

/// A flat grid of unit masses and unit spacing.
Sheet grid(int columns, int rows, double structural, double shear, double bend, double damping = 0.0) {
  Sheet sheet;
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{columns, rows, columns - 1.0, rows - 1.0};
  cloth.mass.value = 1.0;
  cloth.material = scene::Springs{structural, shear, bend, damping, std::nullopt};
  sheet.scene.cloths = {cloth};
  Result<model::Model> built = model::build(sheet.scene);
  REQUIRE(built);
  sheet.model = std::move(*built);
  return sheet;
}

/// One structural spring of 100 N/m between unit masses, 1 m apart.
Sheet one_spring() {
  Sheet two = grid(2, 2, 100, 0, 0);
  two.model.rest_position.resize(2);
  two.model.mass.resize(2);
  two.model.pin_motion.resize(2);
  two.model.elements.of<elements::Spring>().resize(1);
  return two;
}

/// Vertices at random places, springs of all three kinds between random pairs, masses over `decades` powers
/// of ten.
Sheet tangle(std::uint32_t seed, double decades, bool damped, bool pins) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Sheet sheet = grid(2, 2, 100.0, 30.0, 1000.0, damped ? 0.2 : 0.0);
  model::Model& model = sheet.model;
  model = {};
  constexpr std::uint32_t count = 30;
  for (std::uint32_t i = 0; i < count; ++i) {
    model.rest_position.push_back({unit(random), unit(random), unit(random)});
    model.mass.push_back(std::pow(10.0, -decades * unit(random)));
    model.pin_motion.push_back(pins && unit(random) < 0.2 ? 0 : model::not_pinned);
  }
  for (std::uint32_t i = 0; i < 4 * count; ++i) {
    const auto a = static_cast<std::uint32_t>(random() % count),
               b = static_cast<std::uint32_t>(random() % count);
    if (a == b) continue;
    const auto kind = static_cast<model::SpringKind>(random() % 3);
    const double length = glm::distance(model.rest_position[a], model.rest_position[b]);
    const scene::Springs& material = sheet.scene.cloths[0].springs();
    model.elements.of<elements::Spring>().push_back(
        {{std::min(a, b), std::max(a, b)}, {length, model::stiffness(material, kind), material.damping}});
  }
  return sheet;
}

/// omega by repeated multiplication alone.
double power_iteration(const Sheet& sheet, int iterations) {
  const model::ElementOperator springs(sheet.model, sheet.scene, sheet.model.rest_position);
  model::Field y = model::scattered_start(springs), next(y.size()), drag(y.size());
  double squared = 0.0;
  for (int i = 0; i < iterations; ++i) {
    springs.apply(y, next, drag);
    double length = 0.0, quotient = 0.0;
    for (std::size_t v = 0; v < y.size(); ++v) {
      quotient += glm::dot(y[v], next[v]);
      length += glm::dot(next[v], next[v]);
    }
    squared = quotient;
    for (std::size_t v = 0; v < y.size(); ++v) y[v] = next[v] / std::sqrt(length);
  }
  return std::sqrt(squared);
}

/// Energy after many steps of symplectic Euler over that at the start, for the scene linearised about rest.
double energy_gain(const Sheet& sheet, double dt, int steps) {
  const model::ElementOperator springs(sheet.model, sheet.scene, sheet.model.rest_position);
  model::Field x = model::scattered_start(springs), v(x.size()), stiff(x.size()), drag(x.size()),
               unused(x.size());
  const auto energy = [&] {
    springs.apply(x, stiff, unused);
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += glm::dot(x[i], stiff[i]) + glm::dot(v[i], v[i]);
    return sum;
  };
  const double before = energy();
  for (int i = 0; i < steps; ++i) {
    springs.apply(x, stiff, unused);
    springs.apply(v, unused, drag);
    for (std::size_t j = 0; j < x.size(); ++j) {
      v[j] -= dt * (stiff[j] + drag[j]);
      x[j] += dt * v[j];
    }
  }
  return energy() / before;
}

}  // namespace

TEST_CASE(
    "on the grid of equal stiffness the limit tends to that of the infinite grid, the bound says 0.577") {
  // dt_limit in sqrt(m/k), for structural springs, with shear, with bend too.
  const std::array<double, 3> infinite{1.0, std::numbers::sqrt2 / 2, 0.6285};
  const std::array<std::array<double, 3>, 3> stiffness{{{1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};
  for (std::size_t kinds = 0; kinds < 3; ++kinds) {
    for (const int size : {8, 32}) {
      const auto [structural, shear, bend] = stiffness[kinds];
      const Sheet sheet = grid(size, size, structural, shear, bend);
      const double limit = model::dt_limit(sheet.model, sheet.scene);
      INFO("kinds " << kinds << ", size " << size << ", limit " << limit);
      // A part of the infinite grid cannot vibrate faster. Nor much slower: its fastest wave under an
      // envelope cos(pi x / n) loses a share of omega^2 of about (pi / n)^2 for each axis and length.
      CHECK(limit >= 0.9999 * infinite[kinds]);
      const double envelope = std::numbers::pi / size;
      CHECK(limit <= infinite[kinds] * (1.0 + envelope * envelope));
    }
  }
  const Sheet all = grid(32, 32, 1, 1, 1);
  // An inner vertex has sum n n^T = 6 times the unit matrix of the plane: omega^2 <= 12.
  CHECK(model::dt_limit_bound(all.model, all.scene) == Approx(2 / std::sqrt(12.0)).epsilon(1e-12));
  CHECK(model::omega_bound(all.model, all.scene) == Approx(std::sqrt(12.0)).epsilon(1e-12));
}

TEST_CASE("a chain's highest frequency is that of its closed form, free and hanging") {
  // Structural springs alone leave a ladder whose rails are two chains.
  for (const int count : {2, 3, 10, 41}) {
    Sheet chain = grid(2, count, 1, 0, 0);
    const double free = 2 * std::sin(std::numbers::pi * (count - 1) / (2.0 * count));
    CHECK(model::omega_max(chain.model, chain.scene) == Approx(std::max(free, std::sqrt(2.0))).epsilon(1e-3));
    chain.model.pin_motion[0] = chain.model.pin_motion[1] = 0;
    const int hanging = count - 1;
    const double fixed = 2 * std::sin(std::numbers::pi * (2 * hanging - 1) / (2.0 * (2 * hanging + 1)));
    CHECK(model::omega_max(chain.model, chain.scene) ==
          Approx(std::max(fixed, std::sqrt(2.0))).epsilon(1e-3));
  }
}

TEST_CASE("a spring in space: both ends free, one heavy, one pinned") {
  Sheet two = one_spring();
  for (const double ratio : {1.0, 10.0, 1e6}) {
    two.model.mass = {1.0, ratio};
    const double omega = std::sqrt(100.0 * (1.0 + 1.0 / ratio));
    CHECK(model::omega_max(two.model, two.scene) == Approx(omega).epsilon(1e-6));
    CHECK(model::omega_bound(two.model, two.scene) == Approx(std::sqrt(200.0)).epsilon(1e-12));
  }
  two.model.mass = {1.0, 1.0};
  two.model.elements.of<elements::Spring>()[0].law.damping = 3.0;  // M^-1 C of the one vibration: 2 c / m
  two.scene.air_drag = 5.0;
  for (const Method method :
       {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
    two.scene.solver.method = method;
    const double limit = model::dt_limit(method, {200.0, 6.0 + 5.0});
    CHECK(model::dt_limit(two.model, two.scene) == Approx(limit).epsilon(1e-6));
  }
  two.model.pin_motion[1] = 0;
  CHECK(model::omega_max(two.model, two.scene) == Approx(10.0).epsilon(1e-6));
  CHECK(model::omega_bound(two.model, two.scene) == Approx(10.0).epsilon(1e-12));
  two.model.pin_motion[0] = 0;
  for (const Method method : {Method::symplectic_euler, Method::explicit_euler}) {
    two.scene.solver.method = method;
    CHECK(model::dt_limit(two.model, two.scene) == model::no_limit);
    CHECK(model::dt_limit_bound(two.model, two.scene) == model::no_limit);
  }
}

TEST_CASE("a stretched spring vibrates across its direction too") {
  Sheet two = one_spring();
  two.model.pin_motion = {0, model::not_pinned};
  model::Field shape = two.model.rest_position;
  shape[1] = shape[0] + 4.0 * (shape[1] - shape[0]);  // across: k (1 - 1/4)
  const model::ElementOperator springs(two.model, two.scene, shape);
  model::Field across{glm::dvec3(0.0), glm::dvec3(0.0, 1.0, 0.0)}, stiff(2), drag(2);
  springs.apply(across, stiff, drag);
  CHECK(stiff[1].y == Approx(75.0));
}

TEST_CASE("the bound is never below the sharp value, nor the sharp value below the power method's") {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const Sheet sheet = tangle(seed, seed % 2 ? 6.0 : 1.0, false, seed % 3 == 0);
    const double sharp = model::omega_max(sheet.model, sheet.scene);
    INFO("seed " << seed);
    CHECK(model::omega_bound(sheet.model, sheet.scene) >= sharp);
    CHECK(sharp >= 0.9995 * power_iteration(sheet, 3000));
  }
}

TEST_CASE("every bound on the step is on the safe side of the sharp limit, with damping and air") {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Sheet sheet = tangle(seed, 3.0, true, true);
    for (const double air_drag : {0.0, 5.0}) {
      for (const Method method :
           {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4}) {
        sheet.scene.solver.method = method;
        sheet.scene.air_drag = air_drag;
        const double bound = model::dt_limit_bound(sheet.model, sheet.scene);
        INFO("seed " << seed << ", method " << static_cast<int>(method));
        CHECK(bound > 0.0);
        CHECK(bound <= model::dt_limit(sheet.model, sheet.scene));
      }
    }
  }
}

TEST_CASE(
    "stiffness and damping that share no vibrations: symplectic Euler holds under the limit, grows over it") {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Sheet sheet = tangle(seed, 2.0, true, false);
    const double limit = model::dt_limit(sheet.model, sheet.scene);
    INFO("seed " << seed << ", limit " << limit);
    CHECK(energy_gain(sheet, 0.995 * limit, 6000) < 10.0);
    CHECK_FALSE(energy_gain(sheet, 1.005 * limit, 6000) < 1e6);  // or it is no longer a number
  }
}

TEST_CASE("a light vertex among heavy ones sets the limit alone") {
  Sheet sheet = grid(9, 9, 100, 100, 100);
  for (double& mass : sheet.model.mass) mass = 1e6;
  sheet.model.mass[40] = 1.0;  // the middle: sum of n n^T over its 12 springs is 6 along each axis
  CHECK(model::omega_max(sheet.model, sheet.scene) == Approx(std::sqrt(600.0)).epsilon(1e-3));
}

TEST_CASE("without springs, only the air limits the step") {
  Sheet bare = grid(5, 5, 0, 0, 0);
  CHECK(model::dt_limit(bare.model, bare.scene) == model::no_limit);
  CHECK(model::dt_limit_bound(bare.model, bare.scene) == model::no_limit);
  bare.scene.air_drag = 4.0;  // v' = v (1 - 4 dt)
  CHECK(model::dt_limit(bare.model, bare.scene) == Approx(0.5));
  CHECK(model::dt_limit_bound(bare.model, bare.scene) == Approx(0.5));
}

TEST_CASE("two vertices in one place, joined by a spring without length, have a limit and no NaN") {
  Sheet two = one_spring();
  two.model.elements.of<elements::Spring>()[0].law.damping = 1.0;
  two.model.rest_position[1] = two.model.rest_position[0];
  two.model.elements.of<elements::Spring>()[0].law.rest_length = 0.0;
  CHECK(model::dt_limit(two.model, two.scene) == Approx(2 / std::sqrt(200.0)));
  two.scene.solver.method = Method::explicit_euler;
  CHECK(model::dt_limit(two.model, two.scene) == 0.0);
}

TEST_CASE("a search that is told to stop answers with the safe bound") {
  const Sheet sheet = grid(32, 32, 1, 1, 1);
  std::stop_source stop;
  stop.request_stop();
  const model::ElementOperator springs(sheet.model, sheet.scene, sheet.model.rest_position);
  CHECK(model::dt_limit(Method::rk4, springs, stop.get_token()) ==
        model::dt_limit_bound(Method::rk4, springs));
}
