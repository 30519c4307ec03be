// The step on the GPU against the same step in double precision on the CPU.
#include <algorithm>
#include <random>

#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/physics/rounding.h"
#include "tests/physics/stage.h"

using namespace clothlab;

namespace {

reference::State after(const reference::World& world, reference::State state, int steps) {
  for (int n = 0; n < steps; ++n) reference::step(world, state);
  return state;
}

/// For each of `steps` steps, how far the state is off when the rounding of one step disturbs its start. The
/// scene's own dynamics carry a rounding error along; in an unstable direction (a cloth about to buckle) they
/// enlarge it. Found by random disturbances of the reference by a thousandth of that, so that the response is
/// linear.
double largest_growth(const reference::World& world, const Rounding& rounding, int steps) {
  constexpr double part = 1e-3;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  reference::State plain = reference::at_rest(world), disturbed = plain;
  for (std::size_t i = 0; i < plain.position.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      disturbed.position[i][axis] += part * rounding.position[i] * either(random);
      disturbed.velocity[i][axis] += part * rounding.velocity[i] * either(random);
    }
  }
  double largest = 0.0;
  for (int n = 0; n < steps; ++n) {
    reference::step(world, plain);
    reference::step(world, disturbed);
    largest = std::max(largest, reference::rms_distance(plain.position, disturbed.position) / part);
  }
  return largest;
}

}  // namespace

TEST_CASE(
    "each of the seed scene's first 100 steps on the GPU equals a double-precision step to its rounding") {
  const auto context = test::context();
  const scene::Scene seed = preset("seed");
  const reference::World world = world_of(seed);
  const auto simulation = test::simulation(seed);
  double worst = 0.0;
  for (std::uint64_t n = 0; n < 100; ++n) {
    const reference::State before = in_double(simulation->read_state(), n);
    const reference::State expected = after(world, before, 1);
    simulation->step(1);
    const reference::State found = in_double(simulation->read_state(), n + 1);
    const Rounding bound = step_rounding(world, before, expected);
    for (std::size_t i = 0; i < found.position.size(); ++i) {
      worst = std::max({worst, glm::distance(found.position[i], expected.position[i]) / bound.position[i],
                        glm::distance(found.velocity[i], expected.velocity[i]) / bound.velocity[i]});
    }
  }
  INFO("largest error over its bound: " << worst);
  CHECK(worst < 1.0);
  CHECK(worst > 0.01);  // the bound must be near enough to notice an error
}

TEST_CASE("after 1, 10 and 100 steps of the seed scene the GPU is where the double-precision reference is") {
  const auto context = test::context();
  const scene::Scene seed = preset("seed");
  const reference::World world = world_of(seed);
  // Every step adds at most one step's rounding, and the scene carries each of them along.
  const reference::State late = after(world, reference::at_rest(world), 100);
  const Rounding rounding = step_rounding(world, late, late);
  for (const int steps : {1, 10, 100}) {
    const auto simulation = test::simulation(seed);
    simulation->step(static_cast<std::uint32_t>(steps));
    const reference::State found = in_double(simulation->read_state(), 0);
    const reference::State expected = after(world, reference::at_rest(world), steps);
    const double bound = steps * largest_growth(world, rounding, steps);
    const double error = reference::rms_distance(found.position, expected.position);
    INFO(steps << " steps: RMS error " << error << " m, bound " << bound << " m");
    CHECK(error < bound);
    CHECK(bound < 2e-3);  // two thousandths of the cloth: the bound is still sharp enough to find errors
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
Agreement compare_contacts(scene::Scene scene, scene::Method method, std::uint64_t first, int steps) {
  // The last bit may decide if a vertex touches: such vertices are found by moving the surfaces a little.
  const auto moved = [&](double by) {
    reference::World world = world_of(scene);
    for (double& margin : world.contact_margin) margin += by;
    if (world.scene.self_collision) world.scene.self_collision->thickness += by;
    return world;
  };
  const auto simulation = test::simulation(scene);
  simulation->step(static_cast<std::uint32_t>(first));
  scene.solver.method = method;
  REQUIRE(simulation->change(scene));
  const reference::World world = moved(0.0), nearer = moved(-2e-6), farther = moved(2e-6);
  Agreement agreement;
  reference::State expected = in_double(simulation->read_state(), first);
  for (int n = 0; n <= steps; ++n) {
    reference::State before = in_double(simulation->read_state(), first + static_cast<std::uint64_t>(n));
    // The state does not show all: how many contacts share a push, and Verlet's half step, come from the step
    // before.
    before.contacts = expected.contacts;
    before.half_dt = expected.half_dt;
    before.half_velocity = before.velocity;
    for (std::size_t i = 0; i < expected.half_velocity.size(); ++i)
      before.half_velocity[i] -= expected.velocity[i] - expected.half_velocity[i];
    expected = after(world, before, 1);
    const reference::State less = after(nearer, before, 1), more = after(farther, before, 1);
    simulation->step(1);
    const reference::State found = in_double(simulation->read_state(), 0);
    const Rounding bound = step_rounding(world, before, expected);
    if (n == 0) continue;  // these are unknown in the first step
    for (std::size_t i = 0; i < expected.contacts.size(); ++i) {
      if (expected.contacts[i] == 0) continue;
      ++agreement.touching;
      if (less.contacts[i] != expected.contacts[i] || more.contacts[i] != expected.contacts[i])
        ++agreement.undecided;
      else
        agreement.worst = std::max(
            {agreement.worst, glm::distance(found.position[i], expected.position[i]) / bound.position[i],
             glm::distance(found.velocity[i], expected.velocity[i]) / bound.velocity[i]});
    }
  }
  return agreement;
}

}  // namespace

namespace {

/// A method that treats contacts like the reference: all but implicit Euler, which foresees them.
struct Contact {
  scene::Method method;
  int steps;         ///< steps to compare: explicit Euler, unstable here, has only a few before it blows up
  double undecided;  ///< share of contacts that rounding may decide: with explicit Euler what slid along a
                     ///< surface last step now just touches it
  double more;  ///< roundings, as a multiple of those of a step with one evaluation, of which a contact adds
                ///< as many
};
constexpr Contact contact_methods[] = {{scene::Method::explicit_euler, 8, 0.4, 2.0},
                                       {scene::Method::symplectic_euler, 40, 0.1, 2.0},
                                       {scene::Method::verlet, 40, 0.1, 2.0},
                                       {scene::Method::rk4, 40, 0.1, 4.0}};

void check_contacts(const scene::Scene& scene, std::uint64_t first) {
  const auto context = test::context();
  for (const Contact& contact : contact_methods) {
    const Agreement agreement = compare_contacts(scene, contact.method, first, contact.steps);
    INFO(scene::name(contact.method) << ": " << agreement.touching << " contacts, " << agreement.undecided
                                     << " undecided, largest error over its bound " << agreement.worst);
    CHECK(agreement.touching > 5 * contact.steps);
    CHECK(agreement.undecided < contact.undecided * agreement.touching);
    CHECK(agreement.worst < contact.more);
  }
}

}  // namespace

TEST_CASE("a step on the sphere equals the reference wherever rounding cannot decide the contact") {
  check_contacts(preset("seed"), 600);
}

TEST_CASE("a step of two sheets that fall onto each other equals the reference, all pairs tried") {
  check_contacts(two_sheets(), 80);
}
