// Steps a scene on the GPU. One thread owns a Simulation and has its GL context current.
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

struct Hand;
class KeptStates;
struct NearPairs;

/// How much of a simulation a change of scene replaces: nothing, only numbers, also the kernels, or all.
/// Only `cloth` resets time and positions.
enum class ChangeDepth { none, uniform, kernel, cloth };
const char* name(ChangeDepth depth);  ///< "none", "uniform", "kernel", "cloth"

/// How much of a simulation the change from one scene to another replaces; only compares the two scenes.
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
  double pin_force = 0;        ///< springs' pull on a pinned vertex [N], summed over all that move
  double contact_force = 0;    ///< springs' pull + weight of a free vertex [N], summed over all in contact
  double contact_mass = 0;     ///< mass of the free vertices in contact [kg]
  std::uint32_t neighbour_rebuilds = 0;  ///< rebuilds of the neighbour lists since the kernels were made
  std::uint32_t neighbours_dropped =
      0;  ///< neighbours that found no room in a list: self_collision is too thick for the mesh
  std::uint32_t surface_pairs = 0;  ///< that can meet until the next search, under the kind surface
  std::uint32_t surface_cuts =
      0;  ///< steps of vertices that the filter shortened, since the kernels were made
  std::uint32_t surface_forced =
      0;  ///< times that a pin waited, a body may have taken a pair through each other, a solid came over
          ///< a vertex that contact kept where it was, or a step was not taken, the same
  std::uint32_t surface_not_taken =
      0;  ///< steps not taken, or not to their end, as lists had no room for all pairs, the same
  std::uint32_t surface_searches = 0;  ///< searches for pairs, the same

  double total_energy() const { return kinetic + elastic + gravitational; }  ///< [J]
};

/// The state as floats, read back from the GPU.
struct State {
  std::vector<glm::vec3> position;  ///< [vertex_count] [m]
  std::vector<glm::vec3> velocity;  ///< [vertex_count] [m/s]
};

/// FNV-1a, 64 bits, over the bytes of positions and velocities (little-endian float32).
std::uint64_t state_hash(const State& state);

/// Counts of the work of a method that solves equations.
struct SolverWork {
  std::uint64_t linear_iterations = 0;  ///< iterations of conjugate gradients
  std::uint64_t newton_steps = 0;
  std::uint64_t unconverged = 0;  ///< linear solves that ended before the tolerance was met, and steps
                                  ///< whose Newton steps ended before contact between surfaces was solved
};

/// How far the steps of a run are from solved (convergence.h), by the one that was measured last. All 0 for
/// methods that do not iterate.
struct Convergence {
  std::uint64_t measured = 0, unsolved_steps = 0;  ///< steps
  std::uint64_t since_first = 0;                   ///< steps measured since the first that was unsolved
  std::uint64_t step = 0;                          ///< number of the last one
  /// Root of the mean square over the free vertices: how far each ended from where the solved step ends [m].
  double error = 0;
  /// The same over how far the solved step ends from where gravity and inertia alone take the vertices, or
  /// over the way of gravity in a step if that is more: the share of its task that the method has left.
  double residual = 0;
  double largest_error = 0;  ///< of all steps measured [m]
  double tolerance = 0;      ///< a step whose error is larger is unsolved [m]

  bool unsolved() const { return error > tolerance; }
  /// True if half of the steps measured were, or more, since the first that was: a cloth may fall before it
  /// has anything to solve.
  bool often_unsolved() const;
};

/// Counts of the work of the strain limit.
struct StrainLimitWork {
  std::uint64_t sweeps = 0;
  std::uint64_t unconverged = 0;  ///< steps that ended with a spring longer than it may be
};

class Simulation {
 public:
  static Result<std::unique_ptr<Simulation>> create(const scene::Scene& scene,
                                                    std::uint32_t topology_revision = 1);
  ~Simulation();

  /// Applies a changed scene to the running simulation. On error the simulation continues with the old scene.
  Result<ChangeDepth> change(const scene::Scene& scene);

  /// The hands that hold the cloth from the next step on, instead of those before (hands.h). Their holds
  /// belong to this model: a change of the depth `cloth` ends them. Other holds give up the step under way,
  /// other targets do not. Error: the kernels cannot be made.
  Status set_hands(std::vector<Hand> hands);

  /// Queues `count` steps of length dt on the GPU; returns without waiting for them. `timer` times the passes
  /// of the first step: neighbour_search, the method with all that its dispatches do (forces, contacts,
  /// pins), and strain_limit.
  void step(std::uint32_t count, gl::StageTimer* timer = nullptr);

  // `step` in pieces, for a caller that has other things to do while a step takes long: call
  // `set_steps_to_do`, then `resume` for each piece. Between two pieces all other functions may be called and
  // see the state at the end of the last complete step. Functions that change the state, or how it is
  // stepped, give up the step under way.
  /// Sets the number of steps to do, the step under way included; 0 leaves that step where it is. `timer`, as
  /// in `step`, must outlive these steps.
  void set_steps_to_do(std::uint32_t count, gl::StageTimer* timer = nullptr);
  std::uint32_t steps_to_do() const;
  /// Queues the steps to do until they are done or `pace` has enough.
  void resume(Pace& pace);

  /// Puts all vertices back to their start positions, at rest, at time 0.
  void reset();

  double time() const;  ///< [s], sum of the steps' dt without accumulated rounding
  std::uint64_t step_index() const;
  const scene::Scene& scene() const;
  const model::Model& model() const;

  /// A number that changes whenever the triangles, the vertex count or the texture coordinates change.
  std::uint32_t topology_revision() const;

  /// The work of the present method's equation solver since the kernels were made.
  SolverWork solver_work() const;
  /// Since the kernels were made, or the state was set from outside.
  const Convergence& convergence() const;
  /// Whether steps are measured from now on; without a call, they are.
  void measure_convergence(bool on);
  /// Step number `step` is measured, too, even if others are not.
  void measure_step(std::uint64_t step);
  /// How long measurements have taken [s], of the time of all steps.
  double measuring_seconds() const;
  /// The work of the strain limit since the kernels were made.
  StrainLimitWork strain_limit_work() const;
  /// Number of dispatches that the present method has queued since the kernels were made, without those of
  /// the neighbour search and the strain limit.
  std::uint64_t dispatches() const;

  /// Mean number of other vertices that self-collision's search looks at for each vertex, at the start; 0 if
  /// the scene has no self-collision.
  double search_candidates() const;

  /// A pass, which is dispatched, or a term, which is compiled into the kernels of a pass.
  struct Part {
    enum class Kind { pass, term };
    Kind kind;
    std::string name;
    std::string skipped;  ///< why a step does not run this part; empty if a step runs it
  };
  /// All parts that a step can have: the passes in the order in which they run, then the terms.
  std::vector<Part> parts() const;

  /// Diagnostics without waiting for the GPU: call `request_diagnostics`, then `poll_diagnostics` until it
  /// returns true with a result in `out` (usually a frame later).
  void request_diagnostics();
  /// With `wait`, waits for a result that is on its way.
  bool poll_diagnostics(Diagnostics& out, bool wait = false);
  /// From now on requests diagnostics itself after each `steps` steps; 0: never.
  void diagnose_every(std::uint32_t steps);
  /// Diagnostics of the present state, waiting for the GPU.
  Diagnostics diagnose();

  /// Keeps the state of the diagnosis that arrived last as the good state, for `go_back`.
  void keep_diagnosed();
  /// Goes back to the last good state. Until one is kept, that is the state at the start, or after the last
  /// `reset` or `restore`.
  void go_back();

  /// Reads positions and velocities back, waiting for the GPU.
  State read_state();
  /// The pairs near each other that contact keeps apart (near_pairs.h), waiting for the GPU. Changes nothing.
  NearPairs near_pairs();
  /// The inverse of `read_state`: continues from `state`, at `time` [s] and step number `step`. `state` must
  /// have the model's vertex count. It does not hold what a method remembers between steps: that starts anew,
  /// so the next step is not bit for bit the one that would have followed.
  void restore(const State& state, double time, std::uint64_t step);

  /// The states that are kept to go back to, none unless its `every` is set or `keep_state` is called.
  KeptStates& kept();
  /// Keeps the present state. Gives up the step under way.
  void keep_state();
  /// Goes back to the newest kept state at or before `step`, of a simulation that had this scene then. The
  /// states after it are dropped; hands no longer hold. Error: the kernels cannot be made, and nothing has
  /// changed.
  Status go_to_kept(std::uint64_t step, const scene::Scene& scene);
  /// Makes all passes forget what they carry from step to step, as `restore` does. Not to be called within a
  /// step.
  void forget_carried();
  /// True while a step has begun and not ended.
  bool in_step() const;

  /// For tests: the lists of contact between surfaces have room for so many entries, until a step makes them
  /// longer; `for_good`: none does, until the next call. Not to be called within a step.
  void shorten_contact_lists(std::uint32_t entries, bool for_good = false);

  /// Waits until the GPU has finished every queued step.
  void finish();

  /// Binds the positions for reading as READ_VEC4(name, unit).
  void bind_positions(unsigned unit) const;
  /// Binds what a pass over vertices in memory reads: positions, velocities, the elements at each vertex, and
  /// the places in memory of the scene's vertices. False: those places are in the same order, and not bound.
  bool bind_vertices() const;
  /// The colliders with their shapes moved to where they are at the present time, for drawing.
  std::vector<scene::Collider> colliders_now() const;

 private:
  Simulation();
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace clothlab::sim
