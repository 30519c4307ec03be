#include "server/session/engine.h"

#include <mutex>
#include <thread>
#include <utility>

#include "server/base/priority.h"

namespace clothlab::session {

namespace {

/// Creates the helper threads of sessions, at low priority. Helper threads inherit the priority of the
/// thread that makes the first context for them, so a thread of low priority makes that context.
void make_helper_threads(std::optional<int> gpu) {
  static std::once_flag made;
  std::call_once(made, [&] {
    std::thread([&] {
      lower_priority(5);
      (void)gl::Context::create(gpu, gl::HelperThreads::sessions);
    }).join();
  });
}

}  // namespace

Result<std::unique_ptr<Engine>> Engine::create(const scene::Scene& scene, Exchange& exchange,
                                               const Wanted& wanted) {
  auto engine = std::make_unique<Engine>(ComputePlace::claim(scene));
  const gl::HelperThreads threads = engine->place.threads();
  if (threads == gl::HelperThreads::sessions) make_helper_threads(wanted.gpu);
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
