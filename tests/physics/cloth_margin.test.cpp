// The distance that a cloth keeps from solids is its own: other cloths of the scene do not change it.
#include <algorithm>

#include "server/model/motion.h"
#include "tests/sides.h"
#include "tests/solids.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

const scene::Motion motions[] = {
    {}, scene::Linear{{0.0, 4.0, -2.0}}, scene::Spin{{0.6, 0.0, 0.8}, {0.3, 0.0, 0.2}, 400.0}};

/// Unconnected vertices in a heap that fills and surrounds the places of the shapes. The mesh is `cell` [m]
/// fine.
scene::Cloth loose_vertices(double cell) {
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{24, 24, 23.0 * cell, 23.0 * cell};
  cloth.transform.translate = {0.0, 0.0, -11.5 * cell};
  cloth.material = scene::Springs{0.0, 0.0, 0.0, 0.0};
  cloth.start = scene::Scatter{1.0, 3};
  return cloth;
}

/// A sheet that falls on a ball, and, if `far_cell` is not 0, another one far away, pinned, whose cells are
/// so wide [m].
scene::Scene near_and_far(Method method, double far_cell) {
  scene::Scene scene = sheet(9, 9);
  scene.cloths[0].transform.translate = {0.0, 0.3, -0.5};
  scene.cloths[0].material = scene::Springs{200.0, 100.0, 0.0, 0.1};
  scene.cloths[0].mass = {scene::Mass::Kind::per_vertex, 0.01};
  scene.colliders = {{"ball", scene::Sphere{{0.0, 0.0, 0.0}, 0.25}, 0.3, 0.0, {}}};
  scene.solver.method = method;
  scene.solver.dt = 0.002;
  if (far_cell == 0.0) return scene;
  scene::Cloth& far = scene.cloths.emplace_back(scene.cloths[0]);
  far.mesh = scene::Grid{8, 8, 7.0 * far_cell, 7.0 * far_cell};
  far.transform.translate.x = 130.0;
  far.pins = {{scene::AtBox{glm::dvec3(-1e4), glm::dvec3(1e4)}, {}}};
  return scene;
}

}  // namespace

TEST_CASE("each cloth keeps its own distance from a solid, under every method: GPU and reference") {
  const auto context = test::context();
  std::size_t trial = 0;
  for (const Method method : scene::methods) {
    const scene::Shape shape = a_shape_of_each_kind[trial % a_shape_of_each_kind.size()];
    const scene::Motion motion = motions[trial++ % std::size(motions)];
    for (const Side side : sides) {
      scene::Scene scene = sheet(2, 2);
      // The first cloth is neither the finest nor the coarsest.
      scene.cloths = {loose_vertices(0.5), loose_vertices(0.05), loose_vertices(2.0)};
      scene.colliders = {{"solid", shape, 0.0, 0.2, motion}};
      scene.solver.method = method;
      scene.solver.dt = 0.01;
      Stepped stepped(side, scene);
      const model::Model& model = stepped.world().model;
      stepped.step(1);
      const model::Pose pose = model::pose(motion, scene.solver.dt);
      const scene::Shape now = scene::moved_shape(shape, pose.rotation, pose.translation);
      const std::vector<glm::dvec3> places = stepped.state().position;
      for (std::uint32_t cloth = 0; cloth < 3; ++cloth) {
        const double margin = 0.01 * model.cloths[cloth].mean_edge_length;
        double deepest = -1e30;
        for (std::uint32_t i = 0; i < places.size(); ++i)
          if (model.vertex_cloth[i] == cloth) deepest = std::max(deepest, depth(now, places[i]));
        INFO(scene::name(method) << ", " << scene::shape_to_json(shape) << " motion " << motion.index()
                                 << ", " << name(side) << ", cloth " << cloth << " at " << -deepest
                                 << ", margin " << margin);
        // Some float32 roundings at 1 m, of margin, place and shape; at least one vertex lies on it.
        CHECK(deepest == Approx(-margin).margin(2e-6));
      }
    }
  }
}

TEST_CASE("a cloth on a ball lies where it lies alone, however coarse a cloth far away is") {
  const auto context = test::context();
  // Implicit Euler solves for all cloths together, to a tolerance.
  for (const Method method :
       {Method::symplectic_euler, Method::verlet, Method::rk4, Method::pbd, Method::xpbd, Method::vbd}) {
    Stepped alone(Side::gpu, near_and_far(method, 0.0)), beside(Side::gpu, near_and_far(method, 14.0));
    alone.step(150);
    beside.step(150);
    const std::vector<glm::dvec3> expected = alone.state().position, found = beside.state().position;
    INFO(scene::name(method));
    REQUIRE(alone.state().contacts != std::vector<int>(expected.size(), 0));
    CHECK(std::equal(expected.begin(), expected.end(), found.begin()));
  }
}

TEST_CASE("self-collision of a cloth is listed alike however coarse a cloth far away is") {
  const auto context = test::context();
  scene::Scene scene = near_and_far(Method::symplectic_euler, 0.0),
               beside = near_and_far(scene.solver.method, 14.0);
  const auto listed = [](scene::Scene of) {
    of.self_collision = scene::SelfCollision{0.02, 0.2};
    of.cloths[0].mesh = scene::Grid{49, 49, 1.0, 1.0};
    const auto simulation = test::simulation(of);
    simulation->step(5);
    return simulation->diagnose();
  };
  // Each neighbour list holds 64: with the coarse cloth's skin all 2400 others would be on it.
  CHECK(listed(scene).neighbours_dropped == 0);
  CHECK(listed(beside).neighbours_dropped == 0);
}
