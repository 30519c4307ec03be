// Contact between surfaces, after a step of any method (shaders/surface/): pushes that keep triangles and
// edges apart, and a filter that shortens steps so that nothing passes through anything. Dispatched
// indirectly: nothing is done for pairs that are not near, and the host does not wait to find that out.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/carried.h"
#include "server/sim/contact_term.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"
#include "server/sim/surface_bodies.h"
#include "server/sim/surface_pairs.h"
#include "server/sim/work.h"

namespace clothlab::sim {

class SurfaceContact {
 public:
  static Result<SurfaceContact> create(const model::Model& model, const Plan& plan);

  /// Takes over the numbers of a scene; the pairs are searched anew before the next step.
  void set_parameters(const scene::Scene& scene, const model::Model& model, const MotionTable& motions);

  /// The same where only gravity, friction or restitution differ: the pairs stay.
  void set_numbers(const scene::Scene& scene, const model::Model& model, const MotionTable& motions);

  /// Places for which the state's buffers need room behind the cloths' vertices.
  std::uint32_t extra_places() const { return bodies_.count(); }

  /// To be called before a step: places bodies, and brings the pairs up to date (SurfacePairs::update).
  /// `row`: of the motion table, at the step's start.
  Work update_pairs(const StateBuffers& state, int row);
  /// To be called after a step: changes the new state so that it keeps apart and nothing has passed through.
  void keep_apart(StateBuffers& state, int row);

  /// For methods that solve a step's problem: contact is a term of it, with which an iterate begins and ends
  /// (ContactTerm). Null for others.
  ContactTerm* term() { return term_ ? &*term_ : nullptr; }
  void begin_solve(const StateBuffers& state, int row) { term_->begin(state, bodies_, row); }
  std::uint32_t find_pressing(const gl::TextureBuffer& position, bool first) {
    bodies_.bind();
    return term_->find(pairs_, position, first);
  }
  ContactTerm::Limit limit(const gl::TextureBuffer& position, const gl::TextureBuffer& change) {
    bodies_.bind();
    return term_->limit(pairs_, position, change);
  }
  /// Binds and sets what the program that ends a step needs.
  void bind_end(const gl::Program& program) const {
    term_->bind();
    term_->set_solids(program);
    bodies_.bind();
  }
  /// Where the problem's solution has taken all: what comes after it is filtered from there on.
  void end_solve(const gl::TextureBuffer& position) { start_.buffer.copy_from(position.buffer); }

  /// Forgets the pairs and what is carried over from step to step.
  void invalidate();
  /// To be called when a step has ended: the next one brings the pairs up to date anew. A step that is given
  /// up and begins again does not.
  void end_step() { updated_ = false; }
  /// Names the pairs and what is carried over from step to step. Waits for the GPU.
  void carry(Carrier& carrier);

  void shorten_lists(std::uint32_t entries, bool for_good) {
    pairs_.shorten_lists(entries, for_good);
    if (term_) term_->shorten_lists(entries, for_good);
  }
  /// As of SurfacePairs.
  std::vector<SurfacePairs::Pair> read_pairs() const { return pairs_.read_pairs(); }
  bool searched() const { return pairs_.searched(); }

  struct Counters {
    std::uint32_t pairs = 0;   ///< that the last search listed
    std::uint32_t near = 0;    ///< of these, in the last step
    std::uint32_t cuts = 0;    ///< vertices whose steps were shortened, over all steps
    std::uint32_t forced = 0;  ///< times that a pin waited, a body took a pair through each other, a solid
                               ///< came over a vertex that the filter kept, or a step was not taken, the same
    std::uint32_t not_taken = 0;  ///< steps that were not taken, or not to their end, the same
    std::uint32_t rebuilds = 0;   ///< searches
  };
  /// Queues a copy of the counts to `bytes_of_counts` of `target`, from `offset`. `read_counts` makes
  /// Counters of them.
  void copy_counts(const gl::Buffer& target, std::size_t offset) const;
  static Counters read_counts(const std::byte* counts);
  static const std::size_t bytes_of_counts;

 private:
  std::array<const gl::Program*, 12> programs() const;
  /// Takes vertices along the next piece of the step (shaders/surface/advance.comp), from where they are;
  /// `piece` 0: from the step's start, with the pairs that `update_pairs` has brought up to date. False: no
  /// piece can be taken.
  bool advance(const StateBuffers& state, int row, int piece, std::uint32_t changing);
  /// Of a step, or of a piece of it; `row`: of the motion table, at the step's start; `changing`: vertices
  /// that it moves.
  void push_and_filter(StateBuffers& state, int row, std::uint32_t changing, bool last_piece);

  std::uint32_t cloth_vertex_count_ = 0, vertex_count_ = 0;   ///< with the places of bodies
  bool updated_ = false;                                      ///< pairs, for the step under way
  int turn_ = 0;                                              ///< whose step_counts the next step has
  bool driven_ = false;                                       ///< pins, bodies or colliders move
  bool long_steps_ = false;                                   ///< the method's
  int pieces_ = 1;                                            ///< the most in a step
  int push_passes_ = 0, rub_passes_ = 0, filter_passes_ = 0;  ///< in a piece
  bool keeps_start_ = false;  ///< the strain limit writes over the positions at the step's start
  SurfaceBodies bodies_;
  SurfacePairs pairs_;
  std::optional<ContactTerm> term_;
  gl::Program cull_, contacts_, forces_, apply_, begin_, move_, move_last_, path_program_, advance_;
  gl::Program limit_first_, limit_again_, limit_stop_;
  gl::TextureBuffer start_;           ///< of the step, or of the piece under way
  gl::TextureBuffer start_velocity_;  ///< of the step
  gl::TextureBuffer target_, path_, vertex_contacts_, limits_;
  gl::Buffer borne_;  ///< what solids bear of each vertex: shaders/surface/apply.comp
};

}  // namespace clothlab::sim
