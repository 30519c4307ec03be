// What a vertex costs in a step, for a user to compare devices by. Nothing depends on it.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/base/text.h"
#include "server/scene/document.h"
#include "server/selftest/checks.h"
#include "server/sim/guarded_run.h"

namespace clothlab::selftest {

namespace {

Result<Check> speed_of(const std::string& name, int side, double seconds) {
  Result<scene::Document> document = scene::load_preset("hanging-strip");
  if (!document) return document.error();
  scene::Scene scene = document->scene;
  scene.cloths.resize(1);
  scene.cloths[0].mesh = scene::Grid{side, side, 1.0, 1.0};
  scene.cloths[0].pins = {{scene::AtEdge{scene::AtEdge::Line::row, 0}, {}}};
  scene.cloths[0].material = scene::Springs{};
  scene.cloths[0].mass = {scene::Mass::Kind::per_vertex, 0.1};
  scene.solver = {.method = scene::Method::symplectic_euler, .dt = 1e-4};
  const auto simulation = sim::Simulation::create(scene);
  if (!simulation) return simulation.error();
  sim::timed_steps(**simulation, 4);  // drivers compile a kernel when it first runs
  const double once = sim::timed_steps(**simulation, 4) / 4;
  const auto steps = static_cast<std::uint32_t>(std::clamp(seconds / std::max(once, 1e-7), 8.0, 20000.0));
  const double nanoseconds =
      1e9 * sim::timed_steps(**simulation, steps) / steps / (static_cast<double>(side) * side);
  const bool told = std::isfinite(nanoseconds) && nanoseconds > 0.0;
  return Check{
      name,    told, nanoseconds,
      nullptr, "ns", with_significant_digits(nanoseconds, 3) + " ns a vertex and step of symplectic_euler",
      ""};
}

}  // namespace

void tell_speed(Report& report, bool quick) {
  for (const int side : {25, 128, 512}) {
    const std::string name = "speed: " + std::to_string(side) + "x" + std::to_string(side) + " vertices";
    report.make(name, [&] { return speed_of(name, side, quick ? 0.1 : 0.5); });
  }
}

}  // namespace clothlab::selftest
