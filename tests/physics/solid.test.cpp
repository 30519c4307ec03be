// Solids on the GPU and in the reference: each kind against properties of its shape (tests/solids.h).
#include "tests/solids.h"

#include <algorithm>

#include "server/model/motion.h"
#include "tests/sides.h"

using namespace clothlab;
using namespace clothlab::test;

namespace {

const scene::Motion motions[] = {
    {}, scene::Linear{{0.0, 4.0, -2.0}}, scene::Spin{{0.6, 0.0, 0.8}, {0.3, 0.0, 0.2}, 400.0}};

/// Unconnected vertices that fall, in a heap that fills and surrounds the places of the shapes.
scene::Scene loose_vertices(std::vector<scene::Collider> colliders) {
  scene::Scene scene = sheet(24, 24);
  scene.cloths[0].material = scene::Springs{0.0, 0.0, 0.0, 0.0};
  scene.cloths[0].transform.translate = {0.0, 0.0, -0.5};
  scene.cloths[0].start = scene::Scatter{1.0, 3};
  scene.colliders = std::move(colliders);
  scene.solver.dt = 0.01;
  return scene;
}

}  // namespace

TEST_CASE("no vertex is left inside a solid, of any kind, that stands, moves or turns: GPU and reference") {
  const auto context = test::context();
  for (const scene::Shape& shape : a_shape_of_each_kind)
    for (const scene::Motion& motion : motions)
      for (const Side side : sides) {
        INFO(scene::shape_to_json(shape) << " motion " << motion.index() << ", " << name(side));
        // No friction: it acts along the surface as it was, and this one turns by degrees per step.
        const scene::Scene scene = loose_vertices({{"solid", shape, 0.0, 0.2, motion}});
        Stepped stepped(side, scene), free(side, loose_vertices({}));
        const double margin = stepped.world().contact_margin[0];
        REQUIRE(margin > 0.0);
        for (int n = 1; n <= 10; ++n) {
          stepped.step(1);
          free.step(1);
          const model::Pose pose = model::pose(motion, n * scene.solver.dt);
          const scene::Shape now = scene::moved_shape(shape, pose.rotation, pose.translation);
          double deepest = -1.0;
          const reference::State state = stepped.state();
          for (const glm::dvec3& x : state.position) deepest = std::max(deepest, depth(now, x));
          CHECK(deepest <= -margin + 2e-6);  // some float32 roundings at 1 m, of margin, place and shape
          if (n == 1) CHECK(deepest >= -margin - 2e-6);  // at least one vertex lies on it
        }
        const reference::State state = stepped.state(), fallen = free.state();
        int same = 0, moved = 0;
        for (std::size_t i = 0; i < state.position.size(); ++i)
          ++(state.position[i] == fallen.position[i] ? same : moved);
        CHECK(same > 20);
        CHECK(moved > 20);
      }
}

TEST_CASE("a step against solids of every kind at once is the same on the GPU and in the reference") {
  const auto context = test::context();
  std::vector<scene::Collider> colliders;
  for (const scene::Motion& motion : motions)
    for (const scene::Shape& shape : a_shape_of_each_kind)
      colliders.push_back({std::to_string(colliders.size()), shape, 0.3, 0.2, motion});
  // The later collider comes first in the scene: kinds are met in an order of their own.
  std::reverse(colliders.begin(), colliders.end());
  const scene::Scene scene = loose_vertices(colliders);
  Stepped gpu(Side::gpu, scene), truth(Side::reference, scene);
  gpu.step(1);
  truth.step(1);
  const reference::State found = gpu.state(), wanted = truth.state();
  for (std::size_t i = 0; i < found.position.size(); ++i) {
    CHECK(glm::distance(found.position[i], wanted.position[i]) < 1e-5);
    CHECK(glm::distance(found.velocity[i], wanted.velocity[i]) < 1e-3);
  }
}

TEST_CASE("many solids of a kind, at rest, are met as the reference meets them, one after the other") {
  const auto context = test::context();
  for (const scene::Shape& shape : a_shape_of_each_kind) {
    INFO(scene::shape_to_json(shape));
    std::vector<scene::Collider> colliders;
    for (int n = 0; n < 40; ++n) {  // they overlap: what one stops, the next may stop, too
      const glm::dvec3 place(0.4 * (n % 4) - 0.6, 0.5 * (n / 4 % 3) - 0.5, 0.3 * (n / 12) - 0.5);
      colliders.push_back({std::to_string(n),
                           scene::moved_shape(shape, turned_by({0.1, 0.2 * n, 0.3}), place),
                           0.3,
                           0.2,
                           {}});
    }
    const scene::Scene scene = loose_vertices(colliders);
    Stepped gpu(Side::gpu, scene), truth(Side::reference, scene);
    gpu.step(1);
    truth.step(1);
    const reference::State found = gpu.state(), wanted = truth.state();
    int differ = 0;
    for (std::size_t i = 0; i < found.position.size(); ++i)
      differ += glm::distance(found.position[i], wanted.position[i]) >= 1e-5;
    CHECK(differ == 0);
  }
}

TEST_CASE("solids of two kinds are met in the same order wherever the scene names them") {
  const auto context = test::context();
  std::vector<scene::Collider> colliders;
  for (const scene::Shape& shape : a_shape_of_each_kind)
    colliders.push_back({std::to_string(colliders.size()), shape, 0.3, 0.2, {}});
  const auto one = simulation(loose_vertices(colliders));
  std::reverse(colliders.begin(), colliders.end());
  const auto other = simulation(loose_vertices(colliders));
  one->step(20);
  other->step(20);
  CHECK(sim::state_hash(one->read_state()) == sim::state_hash(other->read_state()));
}
