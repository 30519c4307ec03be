// Free cloths thrown into a heap, where they touch themselves and each other: their contacts do not move the
// whole heap.
#include <algorithm>
#include <glm/geometric.hpp>

#include "tests/physics/rounding.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// Two cloths of 9 x 9 whose vertices start at random places in a cube of 0.6 m; nothing holds them.
scene::Scene tangle(Method method, double dt) {
  scene::Scene scene = bare_scene(method, dt);
  for (unsigned seed = 1; seed <= 2; ++seed) {
    scene::Cloth& cloth = scene.cloths.emplace_back();
    cloth.mesh = scene::Grid{9, 9, 0.4, 0.4};
    cloth.mass = {scene::Mass::Kind::per_vertex, 0.01};
    cloth.material = scene::Springs{800.0, 400.0, 80.0, 0.05};
    cloth.start = scene::Scatter{0.6, seed};
  }
  return scene;
}

struct Drift {
  double momentum = 0;         ///< the largest so far, over the largest sum of its parts' magnitudes
  double centre = 0;           ///< distance that the centre of mass has moved [m]
  double momentum_of_one = 0;  ///< of the first cloth while nothing else touches it
};

Drift drift(Side side, const scene::Scene& scene, double seconds) {
  Stepped stepped(side, scene);
  const model::Model& model = stepped.world().model;
  const auto centre = [&](const reference::State& state) {
    glm::dvec3 sum(0.0);
    double mass = 0.0;
    for (std::size_t i = 0; i < model.mass.size(); ++i) {
      sum += model.mass[i] * state.position[i];
      mass += model.mass[i];
    }
    return sum / mass;
  };
  const glm::dvec3 start = centre(stepped.state());
  Drift worst;
  double scale = 0.0;
  const int steps = static_cast<int>(seconds / scene.solver.dt), part = 25;
  for (int done = 0; done < steps; done += part) {
    stepped.step(part);
    const reference::State state = stepped.state();
    glm::dvec3 sum(0.0), one(0.0);
    double size = 0.0;
    for (std::size_t i = 0; i < model.mass.size(); ++i) {
      const glm::dvec3 momentum = model.mass[i] * state.velocity[i];
      sum += momentum;
      if (i < model.cloths[0].vertex_count) one += momentum;
      size += glm::length(momentum);
    }
    scale = std::max(scale, size);
    worst.momentum = std::max(worst.momentum, glm::length(sum) / scale);
    worst.momentum_of_one = std::max(worst.momentum_of_one, glm::length(one) / scale);
    worst.centre = std::max(worst.centre, glm::distance(centre(state), start));
  }
  return worst;
}

/// Bound of the momentum by rounding, as every force has its opposite: in each step of float32 about 40
/// roundings (12 springs, the contacts) of momenta whose sum is `scale`, evenly to either side.
constexpr double most(Side side) {
  return side == Side::gpu ? 1e-5 : 1e-12;
}

}  // namespace

TEST_CASE("sheets in a heap, crowded beyond the lists' first room, keep their momentum under every method") {
  const auto context = test::context();
  test::Part part(3);
  for (const Side side : sides) {
    for (const Method method : scene::methods) {
      if (method == Method::explicit_euler) continue;  // blows up
      if (part.leaves_out()) continue;                 // each side, most methods on one of them
      // Short enough for springs stretched to ten times their length.
      scene::Scene scene = tangle(method, 5e-4);
      scene.self_collision = scene::SelfCollision{0.03, 0.2};
      const Drift found = drift(side, scene, 0.15);
      INFO(scene::name(method) << ", " << name(side) << ": " << found.momentum << ", centre "
                               << found.centre);
      CHECK(found.momentum < most(side));
      CHECK(found.centre < 1e-4);
    }
  }
}

TEST_CASE("lists that get no more room leave out a pair on both sides: counted, and no momentum lost") {
  const auto context = test::context();
  scene::Scene scene = tangle(Method::xpbd, 1e-3);
  for (scene::Cloth& cloth : scene.cloths) {
    cloth.mesh = scene::Grid{23, 23, 0.2, 0.2};  // far more than 256 vertices within reach of each
    cloth.start = scene::Scatter{0.1, 1 + static_cast<unsigned>(&cloth - scene.cloths.data())};
    cloth.material = scene::Springs{20.0, 10.0, 2.0, 0.05};
  }
  scene.self_collision = scene::SelfCollision{0.08, 0.2};
  const auto simulation = test::simulation(scene);
  simulation->step(2);
  REQUIRE(simulation->diagnose().neighbours_dropped > 0);
  CHECK(drift(Side::gpu, scene, 0.05).momentum < most(Side::gpu));
}

TEST_CASE(
    "a free sheet keeps its momentum under VBD with a single sweep and long steps, and so does each of two") {
  const auto context = test::context();
  for (const Side side : sides) {
    for (const int iterations : {1, 4}) {
      scene::Scene scene = tangle(Method::vbd, 8e-3);
      scene.solver.iterations = iterations;
      const Drift found = drift(side, scene, 1.0);
      INFO(name(side) << ", " << iterations << " iterations: " << found.momentum << ", of one sheet "
                      << found.momentum_of_one << ", centre " << found.centre);
      CHECK(found.momentum < most(side));
      CHECK(found.momentum_of_one < most(side));
      CHECK(found.centre < 1e-5);
    }
  }
}

TEST_CASE("a strain limit keeps a free sheet's momentum") {
  const auto context = test::context();
  for (const Side side : sides) {
    scene::Scene scene = tangle(Method::symplectic_euler, 1e-3);
    for (scene::Cloth& cloth : scene.cloths) cloth.springs().strain_limit = 0.1;
    const Drift found = drift(side, scene, side == Side::gpu ? 2.0 : 0.2);
    INFO(name(side) << ": " << found.momentum << ", centre " << found.centre);
    CHECK(found.momentum < most(side));
    CHECK(found.centre < 1e-4);
  }
}
