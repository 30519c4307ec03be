// Bodies of triangles: cloth stays outside of them under every method, on the GPU, at rest and in motion.
#include <algorithm>
#include <cmath>

#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "tests/body_meshes.h"
#include "tests/methods.h"
#include "tests/scenes.h"

using namespace clothlab;
using glm::dvec3;
using scene::Method;

namespace {

constexpr double radius = 0.15;

/// A sheet of 13 x 13 over 0.4 m, about the origin, that every method steps at 2 ms.
scene::Scene sheet_over(const scene::Collider& body, Method method = Method::symplectic_euler) {
  scene::Scene scene;
  scene::Cloth& cloth = scene.cloths.emplace_back();
  cloth.mesh = scene::Grid{13, 13, 0.4, 0.4};
  cloth.transform.translate = {0.0, 0.0, -0.2};
  cloth.mass = {scene::Mass::Kind::per_vertex, 0.001};
  cloth.material = scene::Springs{10.0, 5.0, 1.0, 0.02};
  scene.colliders = {body};
  scene.self_collision = scene::SelfCollision{0.01, 0.2, scene::ContactKind::surface};
  scene.solver.method = method;
  scene.solver.dt = 0.002;
  scene.air_drag = 0.5;
  return scene;
}

scene::Collider ball(scene::Motion motion = {}) {
  scene::Transform place;
  place.translate = {0.003, -radius - 0.02, 0.002};
  place.scale = radius;
  scene::Collider body = test::body_of(test::ball_mesh(2), place, motion);
  body.friction = 0.3;
  return body;
}

/// Steps for `time` [s] and looks at ten states in between: none may cross anything or be inside of a body.
void stays_outside(sim::Simulation& simulation, double time) {
  const model::Model& model = simulation.model();
  const model::Surfaces surfaces = model::surfaces_of(model);
  const auto steps = static_cast<std::uint32_t>(std::lround(time / simulation.scene().solver.dt / 10.0));
  for (int look = 0; look < 10; ++look) {
    simulation.step(steps);
    const sim::State state = simulation.read_state();
    std::vector<dvec3> places(state.position.begin(), state.position.end());
    const std::vector<dvec3> body = model::body_positions(model, simulation.time());
    const model::BodyInside inside(model, 0, body);
    const auto within = std::count_if(places.begin(), places.end(), [&](const dvec3& x) {
      return !std::isfinite(x.x + x.y + x.z) || inside.contains(x);
    });
    for (const dvec3& x : body) places.emplace_back(glm::vec3(x));
    INFO(scene::name(simulation.scene().solver.method) << " at " << simulation.time() << " s");
    CHECK(within == 0);
    CHECK(model::find_crossings(surfaces, places).count == 0);
  }
}

double middle_height(sim::Simulation& simulation) {
  return simulation.read_state().position[6 * 13 + 6].y;
}

}  // namespace

TEST_CASE("a sheet that falls on a ball of triangles drapes over it, under every method and self-collision") {
  const auto context = test::context();
  using Kind = scene::ContactKind;
  const scene::SelfCollision surface{0.01, 0.2, Kind::surface}, points{0.035, 0.2, Kind::points};
  for (const Method method : test::tried_of(scene::methods))
    for (const auto& self :
         {std::optional(surface), std::optional(points), std::optional<scene::SelfCollision>()}) {
      const bool all_kinds =
          method == Method::xpbd || (test::thorough() && method == Method::symplectic_euler);
      if (self != surface && !all_kinds) continue;
      scene::Scene scene = sheet_over(ball(), method);
      scene.self_collision = self;
      const auto simulation = test::simulation(scene);
      stays_outside(*simulation, 0.4);
      // It rests on the ball, at about the thickness; without contact it would have fallen 0.78 m.
      CHECK(middle_height(*simulation) > -0.03);
      CHECK(middle_height(*simulation) < 0.01);
      CHECK(simulation->diagnose().surface_forced == 0);
    }
}

TEST_CASE(
    "a ball of triangles that comes up against a sheet takes it along: at 1, 5 and 10 m/s, and turning") {
  const auto context = test::context();
  for (const Method method : {Method::symplectic_euler, Method::implicit_euler, Method::xpbd})
    for (const double speed : {1.0, 5.0, 10.0}) {
      if (!test::thorough() && (method == Method::implicit_euler) != (speed == 5.0)) continue;
      scene::Scene scene = sheet_over(ball(scene::Linear{{0.0, speed, 0.0}}), method);
      scene.solver.dt = std::min(0.002, 0.01 / speed);  // a step of the ball's is at most the thickness
      const auto simulation = test::simulation(scene);
      stays_outside(*simulation, 0.2);
      CHECK(middle_height(*simulation) > 0.2 * speed - 0.05);
    }
  scene::Spin spin;
  spin.axis = {0.0, 1.0, 0.0};
  spin.degrees_per_second = 360.0;
  const auto turning = test::simulation(sheet_over(ball(spin)));
  stays_outside(*turning, 0.4);
}

TEST_CASE("friction with a body of triangles is that of the body, and runs end in the same bits") {
  const auto context = test::threaded_context();
  const auto run = [](double friction) {
    scene::Transform place;
    place.translate = {0.0, -0.52, 0.0};
    place.scale = 0.5;
    scene::Collider slope = test::body_of(test::cube_mesh(), place);
    slope.friction = friction;
    scene::Scene scene = sheet_over(slope);
    scene.gravity = 9.8 * dvec3(std::sin(0.3), -std::cos(0.3), 0.0);  // tan 0.3 = 0.31
    const auto simulation = test::simulation(scene);
    simulation->step(150);
    return simulation->read_state();
  };
  const sim::State held = run(0.6), slid = run(0.0), again = run(0.6);
  CHECK(sim::state_hash(held) == sim::state_hash(again));
  const std::size_t middle = 6 * 13 + 6;
  // Without friction for 0.3 s: 9.8 sin 0.3 t^2 / 2 = 0.13 m. With it the sheet slides only while it falls 1
  // cm.
  CHECK(slid.position[middle].x == Approx(0.13).margin(0.02));
  CHECK(std::abs(held.position[middle].x) < 0.012);
}

TEST_CASE("what a body forces where it cannot go is counted") {
  const auto context = test::context();
  scene::Scene scene = sheet_over(ball(scene::Linear{{0.0, 0.5, 0.0}}));
  scene::Transform place;
  place.translate = {0.0, 0.56, 0.0};
  place.scale = 0.5;
  scene.colliders.push_back(test::body_of(test::cube_mesh(), place));
  const auto simulation = test::simulation(scene);
  simulation->step(50);  // on its way, with room
  CHECK(simulation->diagnose().surface_forced == 0);
  simulation->step(100);  // 7 cm into the cube above
  CHECK(simulation->diagnose().surface_forced > 0);
}
