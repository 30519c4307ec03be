// The parts of a session that live on the GPU: a context, the simulation, the frame maker and timers. A scene
// that a change makes small or large on software OpenGL moves to another engine (gl/software/software.h).
#pragma once

#include <memory>
#include <optional>

#include "server/base/memory_budget.h"
#include "server/gl/context.h"
#include "server/gl/software/software.h"
#include "server/gl/stage_timer.h"
#include "server/session/frame_maker.h"
#include "server/session/gpu_backlog.h"
#include "server/sim/simulation.h"

namespace clothlab::session {

struct Engine {
  struct Wanted {
    std::optional<int> gpu;
    std::uint32_t last_frame = 0;         ///< the first frame has the number after this
    std::uint32_t topology_revision = 1;  ///< of the mesh
  };
  /// Makes the engine's context current on the calling thread. After an error no context is current.
  static Result<std::unique_ptr<Engine>> create(const scene::Scene& scene, Exchange& exchange,
                                                const Wanted& wanted);
  Engine() = default;
  /// Makes the engine's context current to free what is in it; afterwards no context is current.
  ~Engine();

  MemoryBudget::Reservation memory{};     ///< of its scene; the last to be given back
  std::optional<gl::ComputePlace> place;  ///< on software OpenGL
  std::unique_ptr<gl::Context> context;   ///< before the members below, as they must be freed while it exists
  std::unique_ptr<sim::Simulation> simulation;
  std::unique_ptr<FrameMaker> frames;
  gl::StageTimer step_timer, diagnosis_timer;
  GpuBacklog backlog;
};

}  // namespace clothlab::session
