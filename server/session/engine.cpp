#include "server/session/engine.h"

#include <utility>

#include "server/sim/cost.h"

namespace clothlab::session {

Result<std::unique_ptr<Engine>> Engine::create(const scene::Scene& scene, Exchange& exchange,
                                               const Wanted& wanted) {
  auto engine = std::make_unique<Engine>();
  auto threads = gl::HelperThreads::none;
  if (gl::software_device(wanted.gpu)) {
    threads = engine->place.emplace(gl::ComputePlace::claim(sim::expected_share(scene))).threads();
    gl::make_helper_threads(wanted.gpu, threads);
  }
  Result<std::unique_ptr<gl::Context>> context = gl::Context::create(wanted.gpu, threads);
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

}  // namespace clothlab::session
