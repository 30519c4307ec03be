// Provot's strain limit in the reference.
#include "server/reference/strain_limit.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <random>

#include "server/model/limit_shares.h"
#include "shaders/elements/elements.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using scene::Method;

namespace {

/// Largest l / L - 1 of the springs with a free end.
double largest_stretch(const reference::World& world, const reference::State& state) {
  double largest = 0.0;
  for (const model::Spring& spring : world.model.springs()) {
    if (world.pinned(spring.vertices[0]) && world.pinned(spring.vertices[1])) continue;
    const double length =
        glm::distance(state.position[spring.vertices[0]], state.position[spring.vertices[1]]);
    largest = std::max(largest, length / spring.law.rest_length - 1.0);
  }
  return largest;
}

scene::Scene heavy_cloth(Method method) {
  scene::Scene scene = test::swinging_cloth(method, 2e-4);
  scene.cloths[0].mass.value = 4e-3;
  return scene;
}

}  // namespace

TEST_CASE(
    "after each step of every method no spring is longer than the strain limit allows, which it would be "
    "without") {
  for (const Method method : {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4,
                              Method::implicit_euler}) {
    scene::Scene scene = heavy_cloth(method);
    const int steps = method == Method::implicit_euler ? 40 : 400;
    scene.solver.dt = 0.08 / steps;
    reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    for (int n = 0; n < steps; ++n) reference::step(world, state);
    CHECK(largest_stretch(world, state) > 0.1);

    world.scene.cloths[0].springs().strain_limit = 0.05;
    state = reference::at_rest(world);
    for (int n = 0; n < steps; ++n) {
      reference::step(world, state);
      CHECK(largest_stretch(world, state) <
            0.1 + 2e-12);  // the sweeps' remainder, and a rounding of the test's own
    }
  }
}

TEST_CASE("the strain limit keeps a free sheet's momentum and angular momentum, with unequal masses too") {
  scene::Scene scene = test::swinging_cloth(Method::symplectic_euler, 1e-3);
  scene.cloths[0].pins.clear();
  scene.cloths[0].springs().strain_limit = 0.05;
  scene.cloths[0].mass = {scene::Mass::Kind::area_density, 0.2};
  const reference::World world = world_of(scene);
  reference::State state = reference::at_rest(world);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  for (std::size_t i = 0; i < state.position.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      state.position[i][axis] += 0.01 * either(random);
      state.velocity[i][axis] = either(random);
    }
  const auto momenta = [&](const reference::State& s) {
    std::array<glm::dvec3, 3> sums{};
    for (std::size_t i = 0; i < s.position.size(); ++i) {
      const glm::dvec3 p = world.model.mass[i] * s.velocity[i];
      sums[0] += p;
      // momentum of the corrections: how they move the centre of mass
      sums[1] += world.model.mass[i] * s.position[i];
      sums[2] += glm::cross(world.model.mass[i] * state.position[i], s.velocity[i]);
    }
    return sums;
  };
  reference::State limited = state;
  CHECK(reference::limit_strain(world, limited) <= 1e-12);
  CHECK(glm::distance(limited.position[0], state.position[0]) > 1e-4);
  const auto before = momenta(state), after = momenta(limited);
  // Sums over 289 vertices. A correction is along its spring's present direction, so angular momentum about
  // the earlier positions is kept only up to the corrections' share of the arm.
  CHECK(glm::distance(before[0], after[0]) < 1e-12);
  CHECK(glm::distance(before[1], after[1]) < 1e-15);
}

TEST_CASE("a limit that the pins forbid is reported, and the free vertices still go as far as they can") {
  scene::Scene scene = test::hung_strip(Method::symplectic_euler, 0.01, 2, 3, 1.0, 2.0);
  scene.cloths[0].springs().structural = 16.0;
  scene.cloths[0].springs().strain_limit = 0.1;
  scene.cloths[0].pins.push_back(
      {scene::AtEdge{scene::AtEdge::Line::row, 2}, scene::Linear{{0.0, 0.0, 1.0}}});
  const reference::World world = world_of(scene);
  reference::State state = reference::at_rest(world);
  for (const std::size_t i : {4, 5}) state.position[i].z = 3.0;  // two springs of 1 m over 3 m
  const double left = reference::limit_strain(world, state);
  CHECK(left > 0.3);
  CHECK(left < 0.9);
  CHECK(state.position[4].z == 3.0);
}

namespace {

/// Kinetic and elastic energy [J] of a cloth that travels with `pins` [m/s].
double energy_with(const model::Model& model, const std::vector<glm::dvec3>& x,
                   const std::vector<glm::dvec3>& v, const glm::dvec3& pins) {
  double sum = 0.0;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (model.pin_motion[i] == model::not_pinned)
      sum += 0.5 * model.mass[i] * glm::dot(v[i] - pins, v[i] - pins);
  model::each_element(model.elements, [&](const auto& element) {
    sum += element_energy(element.law, model::edges(element, 0, x));
  });
  return sum;
}

}  // namespace

TEST_CASE(
    "whatever a strain limit corrects while pins move, a cloth takes no share of it that gives energy") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  for (const bool pinned : {true, false})
    for (const double corrects : {1e-6, 1e-4, 1e-2, 1.0}) {
      scene::Scene scene = test::swinging_cloth(Method::xpbd, 5e-3);
      if (!pinned) scene.cloths[0].pins.clear();
      const model::Model model = *model::build(scene);
      const std::size_t count = model.vertex_count();
      const glm::dvec3 pins(2.0, 0.0, 1.0);
      model::LimitedStep step{5e-3, {}, model.rest_position, {}, {}, {}, {}};
      const auto around = [&](double size) {
        return size * glm::dvec3(either(random), either(random), either(random));
      };
      for (std::size_t i = 0; i < count; ++i) {
        const bool held = model.pin_motion[i] != model::not_pinned;
        step.inverse_mass.push_back(held ? 0.0 : 1.0 / model.mass[i]);
        step.start_velocity.push_back(around(1.0));
        step.free.push_back(held ? step.start[i] + step.dt * pins : step.start[i] + around(0.01));
        step.free_velocity.push_back(around(1.0));
        step.limited.push_back(held ? step.free[i] : step.free[i] + around(corrects));
      }
      const auto [place, velocity] = model::limit_shares(model, step).at(0);
      std::vector<glm::dvec3> x = step.free, v = step.free_velocity;
      for (std::size_t i = 0; i < count; ++i) {
        x[i] += place * (step.limited[i] - step.free[i]);
        v[i] += velocity / step.dt * (step.limited[i] - step.free[i]);
      }
      INFO((pinned ? "pinned" : "free")
           << ", corrections of " << corrects << " m: shares " << place << " and " << velocity);
      const glm::dvec3 with = pinned ? pins : glm::dvec3(0.0);
      const double before = std::max(energy_with(model, step.free, step.free_velocity, with),
                                     energy_with(model, step.start, step.start_velocity, with));
      if (pinned) CHECK(energy_with(model, x, v, with) <= before * (1.0 + 2e-5));
      CHECK((place >= 0.0 && place <= 1.0 && velocity >= 0.0 && velocity <= place));
      if (corrects == 1.0 && pinned) CHECK(place < 1.0);
      if (!pinned) CHECK((place == 1.0 && velocity == 1.0));  // nothing forbids the limit
    }
}

TEST_CASE("a correction that takes energy is taken whole") {
  const scene::Scene scene = test::swinging_cloth(Method::xpbd, 5e-3);
  const model::Model model = *model::build(scene);
  model::LimitedStep step{5e-3, {}, model.rest_position, {}, model.rest_position, {}, model.rest_position};
  for (std::size_t i = 0; i < model.vertex_count(); ++i) {
    const bool held = model.pin_motion[i] != model::not_pinned;
    step.inverse_mass.push_back(held ? 0.0 : 1.0 / model.mass[i]);
    // It has flown apart, with the velocity of that; the limit brings it back to where it was.
    const glm::dvec3 flown = held ? glm::dvec3(0.0) : 0.2 * (model.rest_position[i] - model.rest_position[0]);
    step.start_velocity.push_back(flown / step.dt);
    step.free[i] += flown;
    step.free_velocity.push_back(flown / step.dt);
  }
  const auto [place, velocity] = model::limit_shares(model, step).at(0);
  CHECK(place == 1.0);
  CHECK(velocity == 1.0);
}
