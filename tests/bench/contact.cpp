// One of the scenes that are hard on contact (tests/contact_scenes.h), stepped for a while: how many
// crossings its frames have. Prints a line of JSON; tests/bench/contact.mjs makes a table of many.
//   bench_contact SCENE KIND METHOD SIZE THICKNESS SPEED TIME [MOST_SECONDS]
// A frame is a thirtieth of a second, or a step where that is longer. Crossings are edges that meet a
// triangle of a cloth, counted without rounding in double precision (server/model/crossings.h). `deepest_mm`
// is how deep a vertex that no pin holds was in a solid in any frame, -1000 if none was. It ends early,
// and says so, if the simulation diverges or after MOST_SECONDS of wall time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "server/gl/context.h"
#include "server/model/bodies.h"
#include "server/model/crossings.h"
#include "server/sim/simulation.h"
#include "tests/contact_scenes.h"
#include "tests/within_solids.h"

using namespace clothlab;

namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool finite(const sim::State& state) {
  for (const glm::vec3& x : state.position)
    if (!std::isfinite(x.x + x.y + x.z)) return false;
  return true;
}

int fail(const std::string& text) {
  std::fprintf(stderr, "%s\n", text.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 8)
    return fail("usage: bench_contact SCENE KIND METHOD SIZE THICKNESS SPEED TIME [MOST_SECONDS]");
  test::ContactOptions options;
  options.kind = argv[2];
  options.method = argv[3];
  options.size = std::atoi(argv[4]);
  options.thickness = std::atof(argv[5]);
  options.speed = std::atof(argv[6]);
  const double time = std::atof(argv[7]), most_seconds = argc > 8 ? std::atof(argv[8]) : 1e9;

  const auto scenes = test::contact_scenes();
  const auto found =
      std::find_if(scenes.begin(), scenes.end(), [&](const auto& s) { return s.name == argv[1]; });
  if (found == scenes.end()) return fail("no such scene");
  const Result<scene::Document> document = scene::validate(found->document(options));
  if (!document) return fail(document.error().text());
  const Result<std::unique_ptr<gl::Context>> context = gl::Context::create();
  if (!context) return fail(context.error().text());
  Result<std::unique_ptr<sim::Simulation>> made = sim::Simulation::create(document->scene);
  if (!made) return fail(made.error().text());
  sim::Simulation& simulation = **made;

  const model::Surfaces surfaces = model::surfaces_of(simulation.model());
  const double dt = document->scene.solver.dt, start = seconds();
  const auto steps = std::max(1u, static_cast<std::uint32_t>(std::lround(1.0 / (30.0 * dt))));
  std::uint64_t most = 0, frames = 0, crossed = 0;
  double stepping = 0.0, largest_strain = 0.0, deepest = 0.0;
  bool diverged = false;
  while (simulation.time() < time - 0.5 * dt && seconds() - start < most_seconds && !diverged) {
    const double before = seconds();
    simulation.step(steps);
    simulation.finish();
    stepping += seconds() - before;
    const sim::State state = simulation.read_state();
    diverged = !finite(state);
    if (diverged) break;
    std::vector<model::dvec3> places(state.position.begin(), state.position.end());
    for (const model::dvec3& of_body : model::body_positions(simulation.model(), simulation.time()))
      places.emplace_back(glm::vec3(of_body));
    const std::uint64_t count = model::find_crossings(surfaces, places).count;
    ++frames;
    crossed += count > 0;
    most = std::max(most, count);
    deepest = std::max(deepest, test::deepest_in_solids(simulation, state));
    largest_strain = std::max(largest_strain, static_cast<double>(simulation.diagnose().max_strain));
  }
  std::printf(
      "{\"scene\":\"%s\",\"kind\":\"%s\",\"method\":\"%s\",\"size\":%d,\"thickness\":%g,\"speed\":%g,"
      "\"vertices\":%u,\"dt\":%g,\"time\":%.4g,\"frames\":%llu,\"crossed_frames\":%llu,\"most_crossings\":%"
      "llu,"
      "\"diverged\":%s,\"deepest_mm\":%.3g,\"max_strain\":%.3g,\"ns_per_vertex_step\":%.0f}\n",
      argv[1], argv[2], argv[3], options.size, options.thickness, options.speed,
      simulation.model().vertex_count(), dt, simulation.time(), static_cast<unsigned long long>(frames),
      static_cast<unsigned long long>(crossed), static_cast<unsigned long long>(most),
      diverged ? "true" : "false", 1e3 * deepest, largest_strain,
      1e9 * stepping /
          static_cast<double>(simulation.model().vertex_count() *
                              std::max<std::uint64_t>(simulation.step_index(), 1)));
}
