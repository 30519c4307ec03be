// How a sheet of finite elements moves: rigidly at no cost, damped as its law says, and back into shape from
// whatever it was made of.
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "server/model/stability.h"
#include "server/reference/rest_shape.h"
#include "server/scene/method.h"
#include "server/scene/suited.h"
#include "server/sim/guarded_run.h"
#include "tests/physics/stage.h"
#include "tests/sides.h"
#include "tests/small_scenes.h"

using namespace clothlab;
using namespace clothlab::test;
using glm::dvec2;
using glm::dvec3;
using scene::Method;
using Verdict = sim::GuardedRun::Verdict;

namespace {

/// The places of a sheet's vertices from those at rest, x and z.
template <class Place>
scene::Scene placed_sheet(Method method, int side, Place place) {
  scene::Scene scene = sheet_of_elements(method, 1e-4, side);
  scene::TriangleMesh mesh;
  std::vector<dvec2> flat;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      flat.emplace_back(0.25 * column / (side - 1) - 0.125, 0.25 * row / (side - 1));
      mesh.vertices.push_back(place(flat.back(), column, row));
    }
  for (int row = 0; row + 1 < side; ++row)
    for (int column = 0; column + 1 < side; ++column) {
      const auto a = static_cast<std::uint32_t>(row * side + column), b = a + 1,
                 d = a + static_cast<std::uint32_t>(side), c = d + 1;
      for (const auto& [i, j, k] : {std::array{a, b, c}, std::array{a, c, d}}) {
        mesh.triangles.push_back({i, j, k});
        mesh.pattern.push_back({flat[i], flat[j], flat[k]});
      }
    }
  scene.cloths[0].mesh = mesh;
  return scene;
}

/// Turned by an angle about two axes and moved, after it was stretched.
scene::Scene turned(double degrees, double stretch) {
  const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
  return placed_sheet(Method::symplectic_euler, 9, [=](dvec2 flat, int, int) {
    const dvec3 x = stretch * dvec3(flat.x, 0.0, flat.y), about_x(x.x, c * x.y - s * x.z, s * x.y + c * x.z);
    return dvec3(c * about_x.x - s * about_x.y, s * about_x.x + c * about_x.y, about_x.z) +
           dvec3(0.3, 1.0, -0.2);
  });
}

}  // namespace

TEST_CASE("a sheet that is turned and moved has no energy, on the GPU either, and stays where it is") {
  const auto context = test::context();
  for (const double degrees : {90.0, 37.0, 180.0}) {
    const double stretched = test::simulation(turned(degrees, 1.01))->diagnose().elastic;
    const scene::Scene rigid = turned(degrees, 1.0);
    const reference::World world = world_of(rigid);
    const double exact = reference::energy(world, reference::at_rest(world)).elastic;
    const auto simulation = test::simulation(rigid);
    const double found = simulation->diagnose().elastic;
    INFO("turned by " << degrees << " degrees: " << found << " J, in double precision " << exact
                      << " J; stretched by a hundredth " << stretched << " J");
    // The places of about 1 m are rounded to 6e-8 of it, the sides of 0.03 m to 2e-6, and so the strain:
    // squared, 4e-8 of that of a hundredth.
    CHECK(std::abs(found) < 1e-6 * stretched);
    CHECK(std::abs(exact) < 1e-12 * stretched);
    simulation->step(500);
    CHECK(std::abs(simulation->diagnose().elastic) < 1e-6 * stretched);
    // What rounding leaves of stretch is 1e-6 of a length of 0.25 m, moving at the pace of 4400 rad/s.
    CHECK(simulation->diagnose().max_speed < 2e-3);
  }
}

TEST_CASE(
    "a stretched sheet swings at the pace of a bar, and dies away at half its damping times its pace "
    "squared") {
  const auto context = test::context();
  constexpr double length = 0.5, modulus = 50.0, density = 0.2, damping = 2e-3, g = 1.0;
  constexpr int rows = 9;
  for (const Side side : sides) {
    scene::Scene scene = bare_scene(side == Side::gpu ? Method::verlet : Method::rk4, 1e-4);
    scene.gravity = {0.0, 0.0, g};
    scene::Cloth& cloth = scene.cloths.emplace_back();
    cloth.mesh = scene::Grid{2, rows, 0.1, length};
    // By area the corners of the last row would differ, and it would sway.
    cloth.mass = {scene::Mass::Kind::per_vertex, density * 0.1 * length / (2 * (rows - 1))};
    cloth.material = scene::Fem{modulus, modulus, 0.0, 20.0, {1e-5, 1e-5, std::nullopt}, damping, 0.0, {}};
    cloth.pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
    Stepped stepped(side, scene);
    // Begun without stretch: nearly all of it is the slowest vibration about the balance, and the next ones
    // die away nine times as fast or faster.
    const auto rest = reference::rest_shape(world_of(scene));
    REQUIRE(rest);
    const auto end = [](const std::vector<dvec3>& place) {
      return 0.5 * (place[2 * rows - 1].z + place[2 * rows - 2].z);
    };
    const double balance = end(rest->position);
    std::vector<double> time, off;  // of the extremes
    double before = 0.0, now = 0.0;
    constexpr int stride = 20;  // steps: a look every 2 ms, 60 a period
    for (int n = 1; time.size() < 7; ++n) {
      stepped.step(stride);
      const double next = end(stepped.state().position) - balance;
      if (n > 2 && (now - before) * (next - now) < 0.0) {
        const double bend = next - 2 * now + before, slope = 0.5 * (next - before);
        time.push_back((n - 1 - slope / bend) * stride * 1e-4);
        off.push_back(std::abs(now - 0.5 * slope * slope / bend));
      }
      before = now, now = next;
      REQUIRE(n < 1000);
    }
    // From the third extreme to the seventh: two periods.
    const double rate = std::log(off[2] / off[6]) / (time[6] - time[2]);
    const double swing = 4 * std::acos(-1.0) / (time[6] - time[2]);
    // Eight links of equal masses: 2 c/h sin(pi / 34), c^2 = modulus / density.
    const double h = length / (rows - 1);
    const double pace = 2 / h * std::sqrt(modulus / density) * std::sin(std::acos(-1.0) / 34);
    INFO(name(side) << ": " << swing << " rad/s, dies away by " << rate << " /s");
    CHECK(std::sqrt(swing * swing + rate * rate) == Approx(pace).epsilon(5e-3));
    // It is stretched by up to 4e-3, and 1.5 times as much stiffer for it. On the GPU the extremes of some
    // 5e-4 m are known to 3e-8 m.
    CHECK(rate == Approx(0.5 * damping * pace * pace).epsilon(0.01));
  }
}

namespace {

Verdict watched(sim::Simulation& simulation, sim::GuardedRun& guard, double until, std::uint32_t stride) {
  Verdict verdict = Verdict::good;
  while (verdict != Verdict::blown_up && simulation.time() < until) {
    guard.step(stride);
    verdict = guard.judge_now();
  }
  return verdict;
}

}  // namespace

TEST_CASE("a sheet past its limit blows up, and the remedy that is offered holds") {
  const auto context = test::context();
  for (const Method method : {Method::explicit_euler, Method::symplectic_euler, Method::verlet, Method::rk4})
    for (const double share : {1.2, 30.0}) {
      scene::Scene scene = sheet_of_elements(method, 1e-4, 9, 2e-4);
      scene.gravity = {0.0, -9.81, 0.0};
      scene.cloths[0].pins = {{scene::AtCorner{0, 0}, {}}, {scene::AtCorner{8, 0}, {}}};
      const double limit = model::dt_limit(*model::build(scene), scene);
      scene.solver.dt = share * limit;
      const auto simulation = test::simulation(scene);
      sim::GuardedRun guard(*simulation);
      guard.start(limit);
      INFO(scene::name(method) << " at " << share << " of its limit");
      REQUIRE(watched(*simulation, guard, 2.0, 4) == Verdict::blown_up);
      const sim::GuardedRun::Setback setback = guard.go_back();
      INFO(setback.reason << ": " << setback.remedy.text);
      scene.solver.dt = setback.remedy.dt;
      if (setback.remedy.method) scene.solver.method = *setback.remedy.method;
      CHECK_FALSE(scene::unsuited(scene.solver.method, scene));
      REQUIRE(simulation->change(scene));
      guard.set_dt_limit(model::dt_limit(simulation->model(), scene));
      CHECK(watched(*simulation, guard, simulation->time() + 0.5, 8) != Verdict::blown_up);
      CHECK(simulation->diagnose().max_strain < 0.2);
    }
}

TEST_CASE("flattened and inverted triangles find back into shape, or the watch says why not") {
  const auto context = test::context();
  // One vertex lies beyond its neighbours: six triangles around it are inverted or flat. Or two thirds of the
  // sheet are pressed to nearly a line.
  const auto beyond = [](dvec2 flat, int column, int row) {
    return dvec3(flat.x + (column == 3 && row == 3 ? 0.05 : 0.0), 0.0,
                 flat.y + (column == 3 && row == 3 ? 0.04 : 0.0));
  };
  const auto pressed = [](dvec2 flat, int, int) {
    return dvec3(flat.x, 1e-4 * std::sin(40 * flat.x), 0.02 * flat.y);
  };
  for (const Method method : {Method::symplectic_euler, Method::implicit_euler, Method::xpbd, Method::vbd})
    for (const bool line : {false, true}) {
      scene::Scene scene = line ? placed_sheet(method, 7, pressed) : placed_sheet(method, 7, beyond);
      scene.cloths[0].pins = {{scene::AtVertex{0}, {}}, {scene::AtVertex{6}, {}}};
      scene.gravity = {0.0, -9.81, 0.0};
      scene.air_drag = 2.0;
      std::get<scene::Fem>(scene.cloths[0].material).damping = 3e-4;
      scene.solver.iterations = scene::sweeps(method) ? 20 : 5;
      scene.solver.tolerance = 1e-5;
      const double limit = model::dt_limit(*model::build(scene), scene);
      scene.solver.dt = scene::iterates(method) ? 2e-3 : 0.5 * limit;
      const auto simulation = test::simulation(scene);
      sim::GuardedRun guard(*simulation);
      guard.start(limit);
      const Verdict verdict = watched(*simulation, guard, 0.5, scene::iterates(method) ? 10 : 100);
      const sim::Diagnostics end = simulation->diagnose();
      INFO(scene::name(method) << (line ? ", pressed to a line" : ", a vertex beyond its neighbours")
                               << ": strain " << end.max_strain
                               << (verdict == Verdict::blown_up ? ", " + guard.reason() : ""));
      if (verdict == Verdict::blown_up) CHECK_FALSE(guard.go_back().remedy.text.empty());
      // Its weight stretches it by some hundredths at the pins.
      else
        CHECK((end.finite && end.max_strain < 0.3));
    }
}
