// The parts of a session that live on the GPU: a context, the simulation, the frame maker and timers. On
// software OpenGL a scene that is too heavy for real time shares helper threads only with other heavy scenes,
// so that it does not slow light ones. A scene that a change makes heavy or light moves to another engine.
#pragma once

#include <memory>
#include <optional>

#include "server/gl/context.h"
#include "server/gl/stage_timer.h"
#include "server/session/frame_maker.h"
#include "server/session/gpu_backlog.h"
#include "server/sim/simulation.h"

namespace clothlab::session {

struct Engine {
  struct Wanted {
    std::optional<int> gpu;
    gl::HelperThreads threads = gl::HelperThreads::light_sessions;
    std::uint32_t last_frame = 0;         ///< the first frame has the number after this
    std::uint32_t topology_revision = 1;  ///< of the mesh
  };
  /// Makes the engine's context current on the calling thread. After an error no context is current.
  static Result<std::unique_ptr<Engine>> create(const scene::Scene& scene, Exchange& exchange,
                                                const Wanted& wanted);
  /// Makes the engine's context current to free what is in it; afterwards no context is current.
  ~Engine();

  /// The helper threads for a scene that runs on `present`. A scene near the boundary between light and heavy
  /// stays there.
  static gl::HelperThreads threads_for(const scene::Scene& scene,
                                       gl::HelperThreads present = gl::HelperThreads::light_sessions);
  /// True on software OpenGL; only there helper threads matter.
  bool software() const { return context->device().software; }

  gl::HelperThreads threads = gl::HelperThreads::light_sessions;
  std::unique_ptr<gl::Context> context;  ///< before the members below, as they must be freed while it exists
  std::unique_ptr<sim::Simulation> simulation;
  std::unique_ptr<FrameMaker> frames;
  gl::StageTimer step_timer, diagnosis_timer;
  GpuBacklog backlog;
};

}  // namespace clothlab::session
