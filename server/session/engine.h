// What of a session lives on the GPU: a context, the simulation in it, what makes its frames, and timers. A
// scene that is too heavy to be stepped in real time shares software OpenGL's helper threads with its like
// only, so that it slows no light one: where a change makes a scene heavy or light it gets another engine.
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
    std::uint32_t last_frame = 0;         ///< frames are numbered from after this one
    std::uint32_t topology_revision = 1;  ///< of its mesh
  };
  /// Makes its context current here. On error none is.
  static Result<std::unique_ptr<Engine>> create(const scene::Scene& scene, Exchange& exchange,
                                                const Wanted& wanted);
  /// Makes its context current here, and then none.
  ~Engine();

  /// Those for a scene that now has `present` threads. A scene near the boundary keeps what it has.
  static gl::HelperThreads threads_for(const scene::Scene& scene,
                                       gl::HelperThreads present = gl::HelperThreads::light_sessions);
  /// Whether helper threads mean anything to it.
  bool software() const { return context->device().software; }

  gl::HelperThreads threads = gl::HelperThreads::light_sessions;
  std::unique_ptr<gl::Context> context;  ///< the first member: the others are freed in it
  std::unique_ptr<sim::Simulation> simulation;
  std::unique_ptr<FrameMaker> frames;
  gl::StageTimer step_timer, diagnosis_timer;
  GpuBacklog backlog;
};

}  // namespace clothlab::session
