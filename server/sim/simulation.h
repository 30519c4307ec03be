// A scene being stepped on the GPU. One thread owns a Simulation, its GL context current there.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/gl/context.h"
#include "server/gl/stage_timer.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/work.h"

namespace clothlab::sim {

/// How deep a change of scene cuts. Only `cloth` resets time and positions.
enum class ChangeDepth { none, uniform, kernel, cloth };
const char* name(ChangeDepth depth);  ///< "none", "uniform", "kernel", "cloth"

/// How deep the change from one scene to another cuts; a pure comparison of documents.
ChangeDepth change_depth(const scene::Scene& from, const scene::Scene& to);

/// Sums over the whole state, made by a reduction on the GPU.
struct Diagnostics {
  double time = 0;  ///< [s]
  std::uint64_t step = 0;
  double kinetic = 0;          ///< [J]
  double elastic = 0;          ///< [J]
  double gravitational = 0;    ///< [J], 0 at the origin
  double max_strain = 0;       ///< largest |l/L - 1| over the springs
  double max_speed = 0;        ///< [m/s]
  std::uint32_t contacts = 0;  ///< vertices touching a collider or another vertex
  bool finite = true;          ///< no NaN or infinity anywhere
  double pin_force = 0;        ///< sum of the springs' pulls at each moving pinned vertex [N]
  double contact_force = 0;    ///< the same, with the weight, of free vertices that touch something [N]
  double contact_mass = 0;     ///< of these [kg]
  std::uint32_t neighbour_rebuilds = 0;  ///< of the neighbour lists, since the kernels were made
  std::uint32_t neighbours_dropped =
      0;  ///< that found no room in a list: self_collision is too thick for the mesh
};

/// The state as floats, read back from the GPU.
struct State {
  std::vector<glm::vec3> position;  ///< [vertex_count] [m]
  std::vector<glm::vec3> velocity;  ///< [vertex_count] [m/s]
};

/// FNV-1a, 64 bits, over the bytes of positions and velocities (little-endian float32).
std::uint64_t state_hash(const State& state);

/// What a method that solves equations has done.
struct SolverWork {
  std::uint64_t linear_iterations = 0;  ///< of conjugate gradients
  std::uint64_t newton_steps = 0;
  std::uint64_t unconverged = 0;  ///< linear solves that ended before the tolerance was met
};

/// What the strain limit has done.
struct StrainLimitWork {
  std::uint64_t sweeps = 0;
  std::uint64_t unconverged = 0;  ///< steps that ended with a spring longer than it may be
};

class Simulation {
 public:
  static Result<std::unique_ptr<Simulation>> create(const scene::Scene& scene,
                                                    std::uint32_t topology_revision = 1);
  ~Simulation();

  /// Applies a changed scene live; on error the old one goes on.
  Result<ChangeDepth> change(const scene::Scene& scene);

  /// Queues `count` fixed steps of dt on the GPU; returns without waiting for them. `timer` times the passes
  /// of the first: neighbour_search, the method with all that its dispatches do (forces, contacts, pins), and
  /// strain_limit.
  void step(std::uint32_t count, gl::StageTimer* timer = nullptr);

  // The same in pieces, for who has other things to do while a step takes long. Between two pieces all other
  // calls are allowed, and see the state of the last step that has ended; those that change the state, or how
  // it is stepped, give up the step that is under way.
  /// So many steps are to be done, the one under way counted: 0 leaves it where it is. `timer` lives on.
  void want(std::uint32_t count, gl::StageTimer* timer = nullptr);
  std::uint32_t wanted() const;
  /// Queues what is wanted until `pace` has enough.
  void resume(Pace& pace);

  /// Back to the start positions, at rest, at time 0.
  void reset();

  double time() const;  ///< [s], exact sum of the steps' dt
  std::uint64_t step_index() const;
  const scene::Scene& scene() const;
  const model::Model& model() const;

  /// Changes whenever triangles, vertex count or texture coordinates do.
  std::uint32_t topology_revision() const;

  /// What the present method's equation solver has done since the kernels were made.
  SolverWork solver_work() const;
  /// What the strain limit has done since the kernels were made.
  StrainLimitWork strain_limit_work() const;
  /// Dispatches that the present method has queued since the kernels were made, without self-collision's.
  std::uint64_t dispatches() const;

  /// Others that self-collision's search holds each vertex against, in the mean at the start; 0 without.
  double search_candidates() const;

  /// A pass, which is dispatched, or a term, which is compiled into the kernels of a pass.
  struct Part {
    enum class Kind { pass, term };
    Kind kind;
    std::string name;
    std::string skipped;  ///< empty: a step runs it; else why not
  };
  /// What a step can be made of: the passes in the order in which they run, then the terms.
  std::vector<Part> parts() const;

  /// Diagnostics without stalling: request, then poll until a value comes back (usually a frame later).
  void request_diagnostics();
  bool poll_diagnostics(Diagnostics& out);
  /// Diagnostics of the present state, waiting for the GPU.
  Diagnostics diagnose();

  /// The state of the diagnosis that came last is sound: one to go back to.
  void keep_diagnosed();
  /// Back to the last state that was kept, or to the start if none was since.
  void go_back();

  /// Positions and velocities, waiting for the GPU.
  State read_state();
  /// The inverse: goes on from there. `state` has the model's vertex count. What a method remembers between
  /// steps is not in it and starts anew, so that the next step is not bit for bit what it would have been.
  void restore(const State& state, double time, std::uint64_t step);

  /// Waits until the GPU has finished every queued step.
  void finish();

  /// Binds the positions for reading as READ_VEC4(name, unit).
  void bind_positions(unsigned unit) const;
  /// Colliders' poses at the present time, for drawing: center of each sphere, point of each plane [m].
  std::vector<scene::Collider> colliders_now() const;

 private:
  Simulation();
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::sim
