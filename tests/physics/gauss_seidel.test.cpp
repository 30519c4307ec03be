// PBD, XPBD and VBD on the GPU against the double-precision reference, step by step, and against implicit
// Euler.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/physics/rounding.h"
#include "tests/physics/stage.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using scene::Method;

namespace {

constexpr std::array methods{Method::pbd, Method::xpbd, Method::vbd};

/// Largest differences of a step from the reference's, over the bound of its rounding.
struct Worst {
  double position = 0, velocity = 0;
};

/// Bound of float32's error in a vertex's displacement in one step [m]. Each visit takes a difference of
/// places, a length and a direction from it, and a product: up to 16 roundings of the spring's length, which
/// the spring passes to its ends. Later sweeps correct the errors of earlier ones.
std::vector<double> displacement_rounding(const reference::World& world, const reference::State& before,
                                          const reference::State& after) {
  std::vector<double> bound(before.position.size());
  for (std::size_t i = 0; i < bound.size(); ++i)
    bound[i] = 4 * unit_roundoff * glm::distance(before.position[i], after.position[i]);
  for (const model::Spring& spring : world.model.springs()) {
    const double length =
        glm::distance(before.position[spring.vertices[0]], before.position[spring.vertices[1]]);
    for (const std::uint32_t vertex : {spring.vertices[0], spring.vertices[1]})
      bound[vertex] += 16 * unit_roundoff * length;
  }
  return bound;
}

Worst compare(const scene::Scene& scene, int steps) {
  const reference::World world = world_of(scene);
  const auto simulation = test::simulation(scene);
  reference::State expected = reference::at_rest(world);
  Worst worst;
  for (int n = 0; n < steps; ++n) {
    reference::State before = in_double(simulation->read_state(), static_cast<std::uint64_t>(n));
    if (n > 0) before.velocity_before = expected.velocity_before;
    before.contacts = expected.contacts;
    const std::vector<glm::dvec3> velocity = before.velocity;
    expected = before;
    reference::step(world, expected);
    simulation->step(1);
    const reference::State found = in_double(simulation->read_state(), 0);
    const std::vector<double> bound = displacement_rounding(world, before, expected);
    for (std::size_t i = 0; i < bound.size(); ++i) {
      const double ulp = unit_roundoff * glm::length(expected.position[i]);
      worst.position =
          std::max(worst.position, glm::distance(found.position[i], expected.position[i]) / (bound[i] + ulp));
      worst.velocity = std::max(worst.velocity, glm::distance(found.velocity[i], expected.velocity[i]) *
                                                    scene.solver.dt / (bound[i] + ulp));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "each step of PBD, XPBD and VBD on the GPU is the reference's to its rounding, in air, damped, pins "
    "moving") {
  const auto context = test::context();
  for (const Method method : methods) {
    for (const int iterations : {1, 10}) {
      scene::Scene scene = test::swinging_cloth(method, 2 * test::cloth_unit);
      scene.cloths[0].springs().damping = 0.01;
      scene.cloths[0].pins[0].motion = scene::Oscillate{{0.0, 0.0, 1.0}, 0.02, 5.0};
      scene.air_drag = 0.5;
      scene.solver.iterations = iterations;
      const Worst worst = compare(scene, 60);
      INFO(scene::name(method) << ", " << iterations << " iterations: " << worst.position << ", "
                               << worst.velocity);
      CHECK(worst.position < 1.0);
      CHECK(worst.velocity < 1.0);
      CHECK(worst.velocity > 0.01);
    }
  }
}

namespace {

struct Agreement {
  int touching = 0;   ///< vertices in contact, over all steps
  int undecided = 0;  ///< those of them that rounding could decide otherwise
  double worst = 0;   ///< largest error of the other vertices over the bound of one step's rounding
};

/// Runs symplectic Euler to step `first`, then `method`; compares each of its steps with a reference step
/// from the GPU's own state before it.
Agreement compare_contacts(scene::Scene scene, Method method, int iterations, std::uint64_t first,
                           int steps) {
  // The last bit may decide if a vertex touches, and with it how its other contacts share: such vertices are
  // found by moving the surfaces a little.
  constexpr double little = 1e-7;
  scene.solver.iterations = iterations;
  const auto simulation = test::simulation(scene);
  simulation->step(static_cast<std::uint32_t>(first));
  scene.solver.method = method;
  REQUIRE(simulation->change(scene));
  const auto moved = [&](double by) {
    reference::World world = world_of(scene);
    for (double& margin : world.contact_margin) margin += by;
    if (world.scene.self_collision) world.scene.self_collision->thickness += by;
    return world;
  };
  const reference::World world = moved(0.0), nearer = moved(-little), farther = moved(little);
  const auto after = [](const reference::World& in, reference::State state) {
    reference::step(in, state);
    return state;
  };
  Agreement agreement;
  reference::State expected = in_double(simulation->read_state(), first);
  for (int n = 0; n <= steps; ++n) {
    reference::State before = in_double(simulation->read_state(), first + static_cast<std::uint64_t>(n));
    before.contacts = expected.contacts;
    before.velocity_before = expected.velocity_before;
    expected = after(world, before);
    const reference::State less = after(nearer, before), more = after(farther, before);
    simulation->step(1);
    const reference::State found = in_double(simulation->read_state(), 0);
    const std::vector<double> bound = displacement_rounding(world, before, expected);
    if (n == 0) continue;  // the contacts before the first step are unknown
    for (std::size_t i = 0; i < bound.size(); ++i) {
      // If a contact acts, moving the surfaces moves the vertex; if it acts in both cases, by equal amounts.
      const glm::dvec3 down = expected.position[i] - less.position[i],
                       up = more.position[i] - expected.position[i];
      if (glm::length(up) + glm::length(down) < 0.1 * little) continue;
      ++agreement.touching;
      if (glm::distance(up, down) > 0.05 * little) {
        ++agreement.undecided;
        continue;
      }
      // A surface is a radius and a centre of up to a metre, in float32.
      const double most = bound[i] + unit_roundoff * (glm::length(expected.position[i]) + 4.0);
      agreement.worst =
          std::max({agreement.worst, glm::distance(found.position[i], expected.position[i]) / most,
                    glm::distance(found.velocity[i], expected.velocity[i]) * scene.solver.dt / most});
    }
  }
  return agreement;
}

void check_contacts(const scene::Scene& scene, std::uint64_t first) {
  const auto context = test::context();
  for (const Method method : methods) {
    for (const int iterations : {1, 4}) {
      const Agreement agreement = compare_contacts(scene, method, iterations, first, 8);
      INFO(scene::name(method) << ", " << iterations << " iterations: " << agreement.touching << " contacts, "
                               << agreement.undecided << " undecided, largest error over its bound "
                               << agreement.worst);
      CHECK(agreement.touching > 30);
      CHECK(agreement.undecided < 0.5 * agreement.touching);
      CHECK(agreement.worst < 1.0);
    }
  }
}

}  // namespace

TEST_CASE(
    "a step on the sphere by PBD, XPBD and VBD equals the reference wherever rounding cannot decide the "
    "contact") {
  check_contacts(preset("seed"), 600);
}

TEST_CASE("two sheets that meet: a step by PBD, XPBD or VBD is the reference's, all pairs tried") {
  check_contacts(two_sheets(), 80);
}
