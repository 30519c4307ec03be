// Finite elements that start flattened, in a heap or turned inside out, under every method.
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/sim/guarded_run.h"
#include "tests/curved.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

constexpr std::array methods{Method::explicit_euler,
                             Method::symplectic_euler,
                             Method::verlet,
                             Method::rk4,
                             Method::implicit_euler,
                             Method::xpbd,
                             Method::vbd};

bool finite(const sim::State& state) {
  for (const auto* values : {&state.position, &state.velocity})
    for (const glm::vec3& value : *values)
      if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z)) return false;
  return true;
}

scene::Scene sheet(Method method, const scene::TriangleMesh& mesh) {
  scene::Scene scene = bare_scene(method, 2e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.air_drag = 2.0;
  scene.cloths = {
      curved_cloth(mesh, {60.0, 40.0, 0.3, 15.0, {1e-5, 2e-5, std::nullopt}, 2e-3, 30.0, std::nullopt})};
  scene.cloths[0].pins = {{scene::AtVertex{0}, {}}, {scene::AtVertex{6}, {}}};
  if (scene::iterates(method)) scene.solver.iterations = 20;
  if (!scene::any_step_is_stable(method))
    scene.solver.dt = 0.3 * model::dt_limit(*model::build(scene), scene);
  return scene;
}

struct Outcome {
  bool finite = true, blown_up = false;
  double strain = 0;
};
Outcome outcome(const scene::Scene& scene, double time) {
  const auto simulation = test::simulation(scene);
  sim::GuardedRun guard(*simulation);
  guard.start(model::dt_limit(simulation->model(), scene));
  Outcome result;
  while (simulation->time() < time) {
    guard.step(static_cast<std::uint32_t>(std::max(1.0, 0.02 / scene.solver.dt)));
    if (guard.judge_now() == sim::GuardedRun::Verdict::blown_up) {
      result.blown_up = true;
      guard.go_back();
      result.finite = result.finite && finite(simulation->read_state());
      return result;
    }
    result.finite = result.finite && finite(simulation->read_state());
  }
  result.strain = simulation->diagnose().max_strain;
  return result;
}

}  // namespace

TEST_CASE("explore") {
  const auto context = test::context();
  for (const bool curved : {false, true})
    for (const Method method : methods) {
      const scene::TriangleMesh mesh =
          curved ? cylinder(6, 6, 0.2, 0.2, 8.0, 0.2) : rectangle(6, 6, 0.2, 0.2, 0.2);
      const auto run = [&](const char* what, scene::Start start) {
        scene::Scene scene = sheet(method, mesh);
        scene.cloths[0].start = start;
        const Outcome o = outcome(scene, 2.0);
        std::printf("%d %s %s: finite %d blown %d strain %g (dt %g)\n", curved, scene::name(method), what,
                    o.finite, o.blown_up, o.strain, scene.solver.dt);
        std::fflush(stdout);
      };
      run("line", scene::Stretch{{0.0, 0.0, 1.0}});
      run("line2", scene::Stretch{{1.0, 0.0, 0.0}});
      run("point", scene::Stretch{{0.0, 0.0, 0.0}});
      run("plane", scene::Stretch{{1.0, 0.0, 1.0}});
      run("squeezed", scene::Stretch{{0.1, 1.0, 1.0}});
      run("inside out", scene::Stretch{{-0.5, 1.0, 0.3}});
      run("scatter", scene::Scatter{0.2, 3});
    }
}
