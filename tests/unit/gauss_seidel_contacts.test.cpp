// PBD, XPBD and VBD meet contacts within their iterations: Coulomb's law on a slope, restitution, a collider
// that carries a cloth, two cloths that keep their distance and their momentum. In double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/scene/method.h"
#include "tests/catch.h"
#include "tests/small_scenes.h"
#include "tests/unit/world.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr std::array methods{Method::pbd, Method::xpbd, Method::vbd};
constexpr double g = 9.8;

/// A free cloth of 5 x 5 on a plane through the origin whose normal is `degrees` from up.
scene::Scene on_slope(Method method, double degrees, double friction) {
  scene::Scene scene = test::bare_scene(method, 5e-3);
  const double angle = degrees * std::acos(-1.0) / 180.0;
  scene.gravity =
      g * glm::dvec3(std::sin(angle), -std::cos(angle), 0.0);  // the slope is level, gravity leans
  scene.solver.iterations = 5;
  scene.cloths.emplace_back().mesh = scene::Grid{5, 5, 0.4, 0.4};
  scene.cloths[0].mass.value = 0.01;
  scene.cloths[0].material = scene::Springs{200.0, 200.0, 20.0, 0.02};
  scene.colliders = {{"slope", scene::Plane{}, friction, 0.0, {}}};
  return scene;
}

reference::State after(const scene::Scene& scene, int steps) {
  const reference::World world = world_of(scene);
  reference::State state = reference::at_rest(world);
  for (int n = 0; n < steps; ++n) reference::step(world, state);
  return state;
}

glm::dvec3 mean_velocity(const reference::State& state) {
  glm::dvec3 sum(0.0);
  for (const glm::dvec3& v : state.velocity) sum += v;
  return sum / static_cast<double>(state.velocity.size());
}

double lowest(const reference::State& state) {
  double y = 1e300;
  for (const glm::dvec3& x : state.position) y = std::min(y, x.y);
  return y;
}

}  // namespace

TEST_CASE(
    "a sheet on a slope sticks below the angle of friction and above it slides by Coulomb's law: PBD, XPBD, "
    "VBD") {
  const double friction = 0.5, angle_of_friction = std::atan(friction) * 180.0 / std::acos(-1.0);
  for (const Method method : methods) {
    for (const double degrees : {0.8 * angle_of_friction, 1.5 * angle_of_friction}) {
      const int steps = 200;
      const scene::Scene scene = on_slope(method, degrees, friction);
      const reference::State state = after(scene, steps);
      const double angle = degrees * std::acos(-1.0) / 180.0, time = steps * scene.solver.dt;
      const double expected = std::max(0.0, g * (std::sin(angle) - friction * std::cos(angle)) * time);
      INFO(scene::name(method) << " at " << degrees << " degrees: " << mean_velocity(state).x << " m/s");
      // All vertices slide alike, so springs do not act; each step presses by dt^2 g cos and brakes by
      // friction times that: exact. VBD finds a vertex's friction through the vertex's own matrix, which
      // turns it a little at the corners; five sweeps leave some millionths of that.
      CHECK(std::abs(mean_velocity(state).x - expected) <
            (method == Method::vbd ? 1e-5 * expected : 0.0) + 1e-9);
      CHECK(lowest(state) > -1e-12);
    }
  }
}

TEST_CASE("a sheet carried by a plane that moves sideways goes with it, by friction alone (PBD XPBD VBD)") {
  for (const Method method : methods) {
    scene::Scene scene = on_slope(method, 0.0, 0.5);
    scene.colliders[0].motion = scene::Linear{{0.3, 0.0, 0.1}};
    const reference::State state = after(scene, 100);
    INFO(scene::name(method));
    for (const glm::dvec3& v : state.velocity) CHECK(glm::distance(v, {0.3, 0.0, 0.1}) < 1e-9);
  }
}

TEST_CASE(
    "a sheet dropped flat comes back with its collider's restitution, and without any stays down: PBD, XPBD, "
    "VBD") {
  for (const Method method : methods) {
    for (const double restitution : {0.0, 0.5, 1.0}) {
      scene::Scene scene = on_slope(method, 0.0, 0.2);
      scene.cloths[0].transform.translate = {0.0, 0.5, 0.0};
      scene.colliders[0].restitution = restitution;
      const reference::World world = world_of(scene);
      reference::State state = reference::at_rest(world);
      double fastest = 0.0, bounce = 0.0;  // [m/s], while falling and right after the impact
      for (int n = 0; n < 80 && bounce < 1e-6; ++n) {
        fastest = std::max(fastest, -mean_velocity(state).y);
        reference::step(world, state);
        bounce = std::max(bounce, mean_velocity(state).y);
      }
      INFO(scene::name(method) << ", restitution " << restitution << ": " << fastest << " to " << bounce
                               << " m/s");
      CHECK(bounce == Approx(restitution * fastest).margin(1e-9));
      CHECK(fastest > 3.0);  // sqrt(2 g 0.5 m) = 3.13 m/s
      CHECK(lowest(state) > -1e-12);
    }
  }
}

TEST_CASE(
    "a sphere stops a sheet at its surface: no vertex enters it, and the sheet hangs on it (PBD XPBD VBD)") {
  for (const Method method : methods) {
    scene::Scene scene = on_slope(method, 0.0, 0.5);
    scene.cloths[0].transform.translate = {0.0, 0.6, -0.2};
    scene.colliders = {{"ball", scene::Sphere{{0.01, 0.3, 0.02}, 0.25}, 0.5, 0.0, {}}};
    const reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    double nearest = 1e300;
    int touching = 0;
    for (int n = 0; n < 200; ++n) {
      reference::step(world, state);
      for (std::size_t i = 0; i < state.position.size(); ++i) {
        nearest = std::min(nearest, glm::distance(state.position[i], {0.01, 0.3, 0.02}));
        touching += state.contacts[i] > 0;
      }
    }
    INFO(scene::name(method) << ": nearest " << nearest << " m from the centre, " << touching << " contacts");
    // Every pass ends with the contact, so it is exact; under VBD springs act last where a vertex follows,
    // but each vertex is stopped within its own move.
    CHECK(nearest > 0.25 - 1e-12);
    CHECK(touching > 200 * 5);
  }
}

TEST_CASE("two sheets that meet keep their distance, and all their momentum under PBD and XPBD") {
  for (const Method method : methods) {
    scene::Scene scene = test::bare_scene(method, 2e-3);
    scene.solver.iterations = 10;
    scene::Cloth& lower = scene.cloths.emplace_back();
    lower.mesh = scene::Grid{6, 6, 0.2, 0.2};
    lower.mass.value = 0.002;
    lower.material = scene::Springs{200.0, 100.0, 20.0, 0.02};
    scene::Cloth upper = lower;
    upper.mass.value = 0.001;
    upper.transform.translate = {0.013, 0.04, 0.017};
    scene.cloths.push_back(upper);
    scene.self_collision = scene::SelfCollision{0.03, 0.3};
    const reference::World world = world_of(scene);
    reference::State state = reference::at_rest(world);
    for (std::size_t i = 36; i < 72; ++i) state.velocity[i] = {0.3, -1.0, 0.1};  // 1 m/s is 2 mm a step
    glm::dvec3 start(0.0), end(0.0);
    double nearest = 1e300, size = 0.0;
    int touching = 0;
    for (std::size_t i = 0; i < 72; ++i) start += world.model.mass[i] * state.velocity[i];
    for (int n = 0; n < 60; ++n) {
      reference::step(world, state);
      for (std::size_t i = 0; i < 36; ++i)
        for (std::size_t j = 36; j < 72; ++j)
          nearest = std::min(nearest, glm::distance(state.position[i], state.position[j]));
      for (const int count : state.contacts) touching += count;
    }
    for (std::size_t i = 0; i < 72; ++i) {
      end += world.model.mass[i] * state.velocity[i];
      size += world.model.mass[i] * glm::length(state.velocity[i]);
    }
    INFO(scene::name(method) << ": nearest " << nearest << " m, " << touching
                             << " contacts, momentum changed by " << glm::distance(start, end) / size);
    CHECK(touching > 36);
    CHECK(nearest > 0.8 * 0.03);
    CHECK(glm::distance(start, end) < (method == Method::vbd ? 1e-2 : 1e-13) * size);
  }
}
