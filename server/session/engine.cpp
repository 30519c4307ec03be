#include "server/session/engine.h"

#include <mutex>
#include <thread>
#include <utility>

#include "server/base/priority.h"
#include "server/sim/cost.h"

namespace clothlab::session {

namespace {

/// Creates the helper threads for heavy sessions, at low priority. Helper threads inherit the priority of the
/// thread that makes the first context for them, so a thread of low priority makes that context.
void make_heavy_threads(std::optional<int> gpu) {
  static std::once_flag made;
  std::call_once(made, [&] {
    std::thread([&] {
      lower_priority(5);
      (void)gl::Context::create(gpu, gl::HelperThreads::heavy_sessions);
    }).join();
  });
}

}  // namespace

Result<std::unique_ptr<Engine>> Engine::create(const scene::Scene& scene, Exchange& exchange,
                                               const Wanted& wanted) {
  auto engine = std::make_unique<Engine>();
  engine->threads = wanted.threads;
  if (wanted.threads == gl::HelperThreads::heavy_sessions) make_heavy_threads(wanted.gpu);
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create(wanted.gpu, wanted.threads);
  if (!context) return context.error();
  engine->context = std::move(*context);
  Result<std::unique_ptr<sim::Simulation>> simulation =
      sim::Simulation::create(scene, wanted.topology_revision);
  if (!simulation) return simulation.error();
  engine->simulation = std::move(*simulation);
  Result<std::unique_ptr<FrameMaker>> frames = FrameMaker::create(exchange, wanted.last_frame);
  if (!frames) return frames.error();
  engine->frames = std::move(*frames);
  return engine;
}

Engine::~Engine() {
  if (context) (void)context->make_current();
}

gl::HelperThreads Engine::threads_for(const scene::Scene& scene, gl::HelperThreads present) {
  const bool heavy = present == gl::HelperThreads::heavy_sessions;
  const double share = sim::expected_step_seconds(scene) / scene.solver.dt;
  return share > (heavy ? 0.5 : 1.0) ? gl::HelperThreads::heavy_sessions : gl::HelperThreads::light_sessions;
}

}  // namespace clothlab::session
