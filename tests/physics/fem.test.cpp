// Finite elements on the GPU against the double-precision reference, and what a sheet must do under every
// method.
#include <cmath>
#include <glm/geometric.hpp>

#include "server/reference/trajectory.h"
#include "server/scene/method.h"
#include "tests/physics/stage.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

/// A sheet of 9x9 vertices, orthotropic and turned, hung by two corners. Its longest explicit step is some
/// 0.4 ms.
scene::Scene sheet(Method method) {
  const bool weak = method == Method::explicit_euler;  // it needs damping and short steps
  scene::Scene scene = sheet_of_elements(method, weak ? 2e-5 : 2e-4, 9, weak ? 2e-3 : 2e-4);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
  iterate_well(scene.solver);
  return scene;
}

}  // namespace

TEST_CASE(
    "a sheet of finite elements is on the GPU where the double-precision reference is, under every method") {
  const auto context = test::context();
  for (const Method method : sheet_methods()) {
    const scene::Scene scene = sheet(method);
    Stepped gpu(Side::gpu, scene), reference(Side::reference, scene);
    const int steps = scene::iterates(method) ? 30 : 200;
    gpu.step(steps);
    reference.step(steps);
    const double apart = reference::rms_distance(gpu.state().position, reference.state().position);
    const double fallen =
        glm::distance(reference.state().position[80], world_of(scene).model.rest_position[80]);
    INFO(scene::name(method) << ": " << apart << " m apart after falling " << fallen << " m");
    CHECK(fallen > 5e-5);
    // Each step rounds positions of up to 0.25 m to 2^-25 of them; the steps' roundings add up without order,
    // and the sheet enlarges each at most some ten times. Implicit Euler's solver stops where the rounding of
    // the positions in the stiffest elements' forces begins: at 60 N/m some 1e-6 N a vertex, 3e-4 of its
    // weight.
    const double solver = method == Method::implicit_euler ? 6e-4 * fallen : 0.0;
    CHECK(apart < 10 * std::sqrt(steps) * 0.25 * 0x1p-25 + solver);
  }
}
