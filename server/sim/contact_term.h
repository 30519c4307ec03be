// Contact between surfaces as a term of a step's problem (shaders/surface/term.glsl): what a method that
// minimises inertia, elements and contact together needs of it at each of its iterates. A change is cut where
// pairs would meet: by one share for all vertices, as a vertex that is stopped while its neighbours go on
// would stretch the cloth between them.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <memory>
#include <vector>

#include "server/base/memory_budget.h"
#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/list_memory.h"
#include "server/sim/motion_table.h"
#include "server/sim/plan.h"
#include "server/sim/surface_bodies.h"
#include "server/sim/surface_pairs.h"

namespace clothlab::sim {

/// Lengths that come from a scene's pull come at least from this one [m/s²]: a scene may have none.
constexpr double gravity_at_least = 9.81;

/// The second derivative of a pair's energy [N/m]: `stiffness` times the products of its corners' weights.
struct PressingPair {
  std::array<std::uint32_t, 4> vertices{};  ///< those of bodies are not less than the cloths' number
  std::array<double, 4> weights{};
  glm::dmat3 stiffness{0.0};
};

class ContactTerm {
 public:
  /// `vertex_count`: of the cloths' vertices and, behind them, the bodies'.
  static Result<ContactTerm> create(const model::Model& model, const Plan& plan, std::uint32_t vertex_count);

  void set_parameters(const scene::Scene& scene, const model::Model& model, const MotionTable& motions);
  /// The time in the equations of a step of another length [s] (shaders/methods/bdf2.glsl); until
  /// `set_parameters`.
  void set_dt(double dt, double step_length);
  /// Sets what a program needs that includes shaders/surface/term_solids.glsl.
  void set_solids(const gl::Program& program) const;

  /// For tests: makes the lists this short, until they grow again.
  void shorten_lists(std::uint32_t entries, bool for_good);

  /// To be called when a step begins: where bodies will be at its end. `row`: of the motion table.
  void begin(const StateBuffers& state, const SurfaceBodies& bodies, int row);
  /// Finds the pairs that press at an iterate, and lists them at their vertices. `first`: it is where the
  /// step begins. Returns how many; waits for the GPU.
  std::uint32_t find(const SurfacePairs& pairs, const gl::TextureBuffer& position, bool first);
  /// The pairs that were found last. Waits for the GPU.
  std::vector<PressingPair> read() const;
  /// Binds the lists for shaders/methods/touching.glsl.
  void bind() const;

  struct Limit {
    bool known = false;           ///< the lists have all pairs; false: nothing may move
    std::uint32_t reachable = 0;  ///< listed pairs, and vertices at solids, that may press on the way
    float longest = 0;            ///< longest way of a free vertex [m]
    float pressed = 0;            ///< longest way of a vertex that a pair presses [m]
    /// Friction's difference from what the solve took it to be, as a share of all friction.
    double slips = 0;
  };
  /// Finds the share that may be taken of a change of velocity, and the change of contact's energy at shares
  /// of that. Waits for the GPU.
  Limit limit(SurfacePairs& pairs, const gl::TextureBuffer& position, const gl::TextureBuffer& change);
  /// The share that the method has chosen to take. Waits for the GPU. Solids go it, too.
  float take_share();
  /// Takes bodies along, after the method has taken its share of the way to the next iterate.
  void take(const gl::TextureBuffer& position) const;
  /// Binds the control block for shaders/methods/implicit_term.glsl.
  void bind_shares() const { control_.bind_storage(slot_known_term); }

 private:
  void make_lists(std::uint32_t capacity);
  bool may_have(std::uint32_t capacity);
  std::vector<const gl::Program*> programs() const;  ///< those that the scene needs
  void set_limits(const SurfacePairs& pairs) const;

  std::uint32_t vertex_count_ = 0, cloth_vertex_count_ = 0, capacity_ = 0;
  std::uint32_t most_ = 0;   ///< entries that the lists may have
  std::uint32_t begun_ = 0;  ///< entries that they began with
  bool incomplete_ = false;  ///< there was no memory for all pairs that press
  std::shared_ptr<ListMemory> memory_ = ListMemory::of_thread();  ///< null: the lists are not bounded by it
  MemoryBudget::Reservation grown_;                               ///< bytes that the lists have grown by
  std::uint32_t pressing_ = 0;
  bool bodies_move_ = false, pins_wait_ = false, solids_ = false;
  float dt_ = 0, margin_ = 0, solid_stiffness_ = 0, heaviest_ = 0;
  float gone_ = 0;                        ///< share of the step that bodies and solids have gone
  float last_share_ = 0, last_gone_ = 0;  ///< of the way to the last target, and of the step: taken last
  int row_ = 0;                           ///< of the motion table, the step's first
  gl::Program cull_, cull_way_, pairs_, ranks_program_, lists_, way_program_, limit_, limit_pins_, hold_,
      energy_, friction_, sum_, sum_friction_, bodies_, press_solids_, limit_solids_;
  gl::Buffer control_;
  const gl::TextureBuffer *step_start_ = nullptr,
                          *step_velocity_ = nullptr;  ///< the state's, of the step under way
  gl::TextureBuffer ends_, way_, target_, velocity_;
  gl::TextureBuffer term_pairs_, vertices_, entries_, links_, ranks_, touched_, friction_energies_;
};

}  // namespace clothlab::sim
