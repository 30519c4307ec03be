// Finite elements that start flattened, in a heap or turned inside out, under every method.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string_view>

#include "server/model/stability.h"
#include "server/scene/method.h"
#include "server/sim/guarded_run.h"
#include "tests/curved.h"
#include "tests/methods.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using scene::Method;

namespace {

bool finite(const sim::State& state) {
  for (const auto* values : {&state.position, &state.velocity})
    for (const glm::vec3& value : *values)
      if (!std::isfinite(value.x) || !std::isfinite(value.y) || !std::isfinite(value.z)) return false;
  return true;
}

scene::Scene sheet(Method method, const scene::TriangleMesh& mesh) {
  scene::Scene scene = bare_scene(method, 4e-3);
  scene.gravity = {0.0, -9.81, 0.0};
  scene.air_drag = 2.0;
  scene.cloths = {
      curved_cloth(mesh, {60.0, 40.0, 0.3, 15.0, {1e-5, 2e-5, std::nullopt}, 1e-3, 30.0, std::nullopt})};
  scene.cloths[0].pins = {{scene::AtVertex{0}, {}}, {scene::AtVertex{4}, {}}};
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

TEST_CASE(
    "a sheet that starts as a line, a plane, a point, inside out or in a heap recovers, or a blow-up is "
    "told") {
  const auto context = test::context();
  const scene::TriangleMesh flat = rectangle(4, 4, 0.2, 0.2, 0.2),
                            curved = cylinder(4, 4, 0.2, 0.2, 8.0, 0.2);
  struct Case {
    const char* what;
    const scene::TriangleMesh* mesh;
    scene::Start start;
  };
  const std::array<Case, 7> cases{{{"line", &flat, scene::Stretch{{0.0, 0.0, 1.0}}},
                                   {"point", &flat, scene::Stretch{{0.0, 0.0, 0.0}}},
                                   {"inside out", &flat, scene::Stretch{{-0.5, 1.0, 0.3}}},
                                   {"heap", &flat, scene::Scatter{0.2, 3}},
                                   {"line of a curved one", &curved, scene::Stretch{{1.0, 0.0, 0.0}}},
                                   {"plane of a curved one", &curved, scene::Stretch{{1.0, 0.0, 1.0}}},
                                   {"heap of a curved one", &curved, scene::Scatter{0.2, 3}}}};
  test::Part part(4);
  for (const Method method : sheet_methods())
    for (const auto& [what, mesh, start] : cases) {
      // Seven cases: each method begins with another one of them.
      if (part.leaves_out()) continue;
      const bool any_step = scene::any_step_is_stable(method);
      if (!any_step && std::string_view(what).starts_with("line"))
        continue;  // many short steps: the rest will do
      scene::Scene scene = sheet(method, *mesh);
      scene.cloths[0].start = start;
      const Outcome found = outcome(scene, 0.8);
      INFO(scene::name(method) << ", " << what << ": strain " << found.strain);
      CHECK(found.finite);
      // Hanging still it is strained by 4 to 7 %; the rest is what still swings.
      CHECK((found.blown_up || found.strain < 0.15));
      // What is stable at any step takes any start.
      if (any_step) CHECK_FALSE(found.blown_up);
    }
}

TEST_CASE("a vertex that starts pushed through the far side of its triangles comes back under every method") {
  const auto context = test::context();
  scene::TriangleMesh fan;  // a ring of six, pinned, and a vertex beside its middle
  fan.vertices.push_back({0.03, 0.0, 0.0});
  for (std::uint32_t k = 0; k < 6; ++k) {
    const double angle = pi / 3.0 * (k + 0.5);
    fan.vertices.push_back({0.1 * std::cos(angle), 0.0, -0.1 * std::sin(angle)});
    fan.triangles.push_back({0, k + 1, (k + 1) % 6 + 1});
  }
  for (const Method method : tried_of(sheet_methods())) {
    scene::Scene scene = sheet(method, fan);
    scene.gravity = {0.0, -0.1, 0.0};
    scene.cloths[0].pins.clear();
    for (std::uint32_t k = 1; k <= 6; ++k) scene.cloths[0].pins.push_back({scene::AtVertex{k}, {}});
    // Beyond the ring's far side, which is 0.087 m from the middle: two triangles are turned over.
    scene.cloths[0].start = scene::Stretch{{-4.5, 1.0, 1.0}};
    const auto start = test::simulation(scene)->read_state().position[0];
    CHECK(start.x < -0.09f);
    const Outcome found = outcome(scene, 0.8);
    INFO(scene::name(method) << ": strain " << found.strain);
    CHECK(found.finite);
    CHECK((found.blown_up || found.strain < 0.01));
    if (scene::any_step_is_stable(method)) CHECK_FALSE(found.blown_up);
  }
}
