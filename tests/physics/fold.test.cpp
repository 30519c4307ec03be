// A cloth folded over slowly: its two layers do not pass through each other, whatever the method's step.
#include <cmath>

#include "tests/crossings.h"
#include "tests/resting.h"
#include "tests/sides.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// A limp cloth of 0.4 m on the ground. One edge is held; the opposite one is carried over to above it, or
/// pushed to it, in 2 s. The vertices keep 0.8 of the mesh's spacing apart, so that none slips between three
/// others.
scene::Scene fold(const scene::Motion& motion, Method method, double dt) {
  scene::Scene scene = sheet_on_slope(0.0, 0.3, 17);
  scene::Cloth& cloth = scene.cloths[0];
  cloth.mass = {scene::Mass::Kind::per_vertex, 0.001};
  cloth.material = scene::Springs{100.0, 50.0, 0.0, 0.0};
  cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}},
                {scene::AtEdge{scene::AtEdge::Line::row, 16}, motion}};
  scene.self_collision = scene::SelfCollision{0.02, 0.2};
  scene.solver.method = method;
  scene.solver.dt = dt;
  return scene;
}

/// Largest number of crossings in 2 s, from eight looks.
std::size_t most_crossings(const scene::Scene& scene) {
  Stepped stepped(Side::gpu, scene);
  std::size_t most = 0;
  for (int look = 0; look < 8; ++look) {
    stepped.step(static_cast<int>(std::lround(0.25 / scene.solver.dt)));
    most = std::max(most, crossings(stepped.world().model, stepped.state().position).size());
  }
  return most;
}

const scene::Motion turned = scene::Spin{{-1.0, 0.0, 0.0}, {0.0, 0.012, 0.0}, 90.0};
const scene::Motion pushed = scene::Linear{{0.0, 0.0, -0.19}};

}  // namespace

TEST_CASE(
    "a cloth folded over slowly goes through itself nowhere, at the explicit methods' steps or at longer "
    "ones") {
  const auto context = test::context();
  struct Run {
    Method method;
    double dt;
  };
  test::Part part(3);
  for (const scene::Motion& motion : {turned, pushed}) {
    for (const Run run : {Run{Method::symplectic_euler, 0.001},
                          {Method::verlet, 0.001},
                          {Method::implicit_euler, 0.004},
                          {Method::implicit_euler, 0.008}}) {
      if (part.leaves_out()) continue;  // turned in short and in long steps, pushed in longer ones
      const std::size_t most = most_crossings(fold(motion, run.method, run.dt));
      INFO(scene::name(run.method) << ", dt " << run.dt << " s, " << (motion == turned ? "turned" : "pushed")
                                   << ": " << most << " edges through triangles");
      CHECK(most == 0);
    }
  }
}
