// Contact between surfaces, at rest: what lies on each other carries, and stays where it is; what slides
// stops.
#include <cmath>

#include "server/scene/suited.h"
#include "server/session/rest.h"
#include "tests/scenes.h"

using namespace clothlab;

namespace {

constexpr double thickness = 0.008, g = 9.8;
/// A tenth of a pixel of a picture that shows a sheet 720 pixels high [m].
constexpr double unseen = 0.24 / 7200;
/// What a sheet that lies on others creeps in a second [m], in short steps and in long ones:
/// shaders/README.md, "Contact between surfaces".
double creep(scene::Method method) {
  return scene::iterates(method) ? 0.0002 : 0.001;
}

scene::Cloth sheet(const glm::dvec3& translate, double turned) {
  scene::Cloth cloth;
  cloth.mesh = scene::Grid{9, 9, 0.24, 0.24};
  cloth.transform = {translate, {0.0, turned, 0.0}, 1.0};
  cloth.mass = {scene::Mass::Kind::area_density, 0.15};
  cloth.material = scene::Springs{300.0, 150.0, 20.0, 0.02};
  return cloth;
}

/// A floor, and surfaces in contact above it.
scene::Scene above_floor(scene::Method method, double friction) {
  scene::Scene scene;
  scene.gravity = {0.0, -g, 0.0};
  scene.air_drag = 0.3;
  scene.self_collision = scene::SelfCollision{thickness, friction, scene::ContactKind::surface};
  scene.colliders = {{"floor", scene::Plane{{0.0, 0.0, 0.0}, {0.0, 1.0, 0.0}}, 0.5, 0.0, {}}};
  scene.solver.method = method;
  scene.solver.dt = scene::iterates(method) ? 0.005 : 2e-4;
  return scene;
}

/// Four sheets over each other, each shifted and turned against the one below it.
scene::Scene four_sheets(scene::Method method) {
  scene::Scene scene = above_floor(method, 0.3);
  for (int layer = 0; layer < 4; ++layer)
    scene.cloths.push_back(sheet({0.01 * layer, 0.005 + 0.01 * layer, -0.12}, 11.0 * layer));
  return scene;
}

/// Mean place of each cloth's vertices [m], and the height of the lowest.
struct Places {
  std::vector<glm::dvec3> mean;
  double lowest = 1.0;
};
Places places(sim::Simulation& simulation) {
  Places places;
  const std::vector<glm::vec3> position = simulation.read_state().position;
  for (const model::ClothRange& cloth : simulation.model().cloths) {
    glm::dvec3 sum(0.0);
    for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i) {
      sum += glm::dvec3(position[i]);
      places.lowest = std::min(places.lowest, static_cast<double>(position[i].y));
    }
    places.mean.push_back(sum / static_cast<double>(cloth.vertex_count));
  }
  return places;
}

}  // namespace

TEST_CASE("the floor carries all sheets that lie on each other: the lowest one neither sinks nor slides") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::implicit_euler,
                                     scene::Method::xpbd, scene::Method::vbd}) {
    // Of long steps, one method's: their contact is the same, and 1.7 s are many short steps.
    if (!test::thorough() && method != scene::Method::vbd) continue;
    const scene::Scene scene = four_sheets(method);
    const auto simulation = test::simulation(scene);
    const auto steps = [&](double seconds) { return static_cast<std::uint32_t>(seconds / scene.solver.dt); };
    constexpr double settled = 1.2, watched = 0.5;  // [s]; what creeps does so evenly
    simulation->step(steps(settled));
    const Places before = places(*simulation);
    simulation->step(steps(watched));
    const Places after = places(*simulation);
    for (std::size_t layer = 0; layer < after.mean.size(); ++layer) {
      const double drift = glm::length(after.mean[layer] - before.mean[layer]);
      INFO(scene::name(method) << ", sheet " << layer << ": " << 1000.0 * drift << " mm in " << watched
                               << " s");
      CHECK(drift < (layer == 0 ? unseen : creep(method)) * watched);
      // What a sheet carries shows as an overlap, and its border hangs over the one below. Where the pushes
      // of a step begin at zero, sheets are a third of the thickness apart at most.
      if (layer > 0) CHECK(after.mean[layer].y - after.mean[layer - 1].y > 0.5 * thickness);
    }
    INFO(scene::name(method) << ": lowest vertex " << 1000.0 * after.lowest << " mm above the floor");
    // Half of the thickness is kept; the filter may take a little of it from a vertex.
    CHECK(after.lowest > 0.95 * 0.5 * thickness);
  }
}

TEST_CASE("a sheet thrown along a floor or over another slides v^2 / (2 mu g) far, and then sticks") {
  const auto context = test::context();
  constexpr double speed = 0.5, friction = 0.25;
  for (const bool over_another : {false, true}) {
    for (const scene::Method method : {scene::Method::symplectic_euler, scene::Method::implicit_euler,
                                       scene::Method::xpbd, scene::Method::vbd}) {
      // One that adds forces up along the floor, one that sweeps over another sheet.
      const auto tried = over_another ? scene::Method::vbd : scene::Method::symplectic_euler;
      if (!test::thorough() && method != tried) continue;
      scene::Scene scene = above_floor(method, friction);
      scene.air_drag = 0.0;
      scene.colliders[0].friction = friction;
      scene.cloths.push_back(sheet({0.0, 0.5 * thickness, -0.12}, 0.0));
      if (over_another) {
        scene.cloths.push_back(sheet({0.0, 1.5 * thickness, -0.12}, 0.0));
        scene.cloths[0].mesh = scene::Grid{13, 13, 0.7, 0.7};
        scene.cloths[0].transform.translate.z = -0.35;
        scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::column, 0}, {}},
                                {scene::AtEdge{scene::AtEdge::Line::column, 12}, {}}};
      }
      const auto simulation = test::simulation(scene);
      const std::size_t thrown = scene.cloths.size() - 1;
      sim::State state = simulation->read_state();
      const model::ClothRange& cloth = simulation->model().cloths[thrown];
      for (std::uint32_t i = cloth.first_vertex; i < cloth.first_vertex + cloth.vertex_count; ++i)
        state.velocity[i].x = static_cast<float>(speed);
      simulation->restore(state, 0.0, 0);
      const double before = places(*simulation).mean[thrown].x, stops = speed / (friction * g);
      simulation->step(static_cast<std::uint32_t>(1.5 * stops / scene.solver.dt));
      const double there = places(*simulation).mean[thrown].x, slid = there - before;
      constexpr double watched = 0.4;  // [s]
      simulation->step(static_cast<std::uint32_t>(watched / scene.solver.dt));
      const double crept = places(*simulation).mean[thrown].x - there;
      const double expected = speed * speed / (2.0 * friction * g);
      INFO(scene::name(method) << (over_another ? ", over another" : ", along the floor") << ": slid " << slid
                               << " m of " << expected << ", then crept " << crept);
      // Of a step's length speed dt the last and the first step lack a part.
      CHECK(std::abs(slid - expected) < 0.03 * expected + speed * scene.solver.dt);
      CHECK(std::abs(crept) < (over_another ? creep(method) : unseen) * watched);
    }
  }
}

TEST_CASE("four sheets that lie on each other fall asleep under the sweeping methods") {
  const auto context = test::context();
  for (const scene::Method method : {scene::Method::vbd, scene::Method::xpbd}) {
    const scene::Scene scene = four_sheets(method);
    const auto simulation = test::simulation(scene);
    session::Rest rest;
    rest.follow(scene, simulation->model());
    constexpr double longest = 10.0;  // [s]: a few stretches that are watched for rest
    double time = 0.0;
    bool asleep = false;
    while (!asleep && time < longest) {
      simulation->step(10);
      time += 10 * scene.solver.dt;
      const sim::State state = simulation->read_state();
      double fastest = 0.0;
      for (const glm::vec3& v : state.velocity)
        fastest = std::max(fastest, static_cast<double>(glm::length(v)));
      asleep = rest.look(time, fastest, [&] { return state.position; });
    }
    INFO(scene::name(method) << ": after " << time << " s");
    CHECK(asleep);
  }
}
