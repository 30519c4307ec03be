// The search for pairs that can meet under contact between surfaces (shaders/surface/): a vertex and a
// triangle, or two edges. The GPU itself asks for a search when one is due (surface_blocks.h). All is
// dispatched indirectly: nothing is done while no search is due, and the host does not wait to find that out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/gl/software/software.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/carried.h"
#include "server/sim/list_memory.h"
#include "server/sim/state.h"
#include "server/sim/surface_blocks.h"
#include "server/sim/surface_triangles.h"
#include "server/sim/work.h"

namespace clothlab::sim {

struct SurfaceControl;

class SurfacePairs {
 public:
  static Result<SurfacePairs> create(const model::Model& model, const SurfaceTriangles& surface);

  /// Takes over the numbers of a scene. `invalidate` must follow.
  /// `pieces`: the most in which a step is gone. `asks_ahead`: `update_for` is called before anything moves,
  /// so that the search need not reach as far as a step may go.
  void set_parameters(const scene::Scene& scene, const model::Model& model, int pieces,
                      bool asks_ahead = false);

  /// The distance that surfaces are kept apart [m]: that of the scene's self-collision, if surfaces keep
  /// apart there; else cloths keep from bodies a tenth of their mean edge, 5 mm at most.
  static double thickness(const scene::Scene& scene, const model::Model& model);

  /// How far a search reaches at least, for parts that lie side by side at rest [m].
  static double least_query(const scene::Scene& scene, const model::Model& model);
  /// The least mean edge of a cloth [m].
  static double finest_edge(const model::Model& model);

  /// To be called before a step: brings the pairs up to date. Rest positions must be bound. Every few calls,
  /// at a fixed count and not by time, reads back how long the lists need to be, and makes them longer, if
  /// there is memory for that (ListMemory). Until then no free vertex moves; where other things do
  /// (`set_driven`), or steps are long enough to go in pieces, it reads back in every call, and waits.
  /// Software OpenGL is asked after every search.
  Work update(const StateBuffers& state);
  /// The same between two pieces of a step, without a stop; a GPU is asked only where other things move.
  /// False: no list may be as long as the pairs need, so no piece can be taken.
  bool update_within_step(const StateBuffers& state);
  /// Lists the pairs before all vertices go straight from `from` to `to`, by `velocity` in a step: no other
  /// pair presses on the way. False: as of update_within_step.
  bool update_for(const gl::TextureBuffer& from, const gl::TextureBuffer& to,
                  const gl::TextureBuffer& velocity, float dt);

  /// To be called where the lists of `update_for` turn out to lack pairs: then nothing may move.
  void leave_out();

  /// `driven`: pins, bodies or colliders move, also while a list is too short.
  void set_driven(bool driven) { driven_ = driven; }

  /// Forgets the pairs; only the counts over all steps stay.
  void invalidate();
  /// For tests: the same, and the lists have room for so many entries until they are made longer; `for_good`:
  /// they may not be.
  void shorten_lists(std::uint32_t entries, bool for_good);
  /// Names the pairs, with all that says how long they hold and how long the lists are.
  void carry(Carrier& carrier);

  /// Binds the pairs, the near pairs and the control block, whose arguments indirect dispatches then take.
  void bind() const;
  /// Sets what a pass after the step needs to know of the search. It may change with every `update`.
  void set_limits(const gl::Program& program) const;
  const gl::Buffer& control() const { return control_; }
  /// True if an indirect dispatch of the groups at this offset in the control block would do nothing.
  /// False on a GPU, which would have to be waited for.
  bool none(std::size_t groups) const;
  /// The same, waiting for a GPU.
  bool none_for_sure(std::size_t groups) const;
  /// Binds what contacts write of each near pair, and what its pushes read and write. The slots are other
  /// buffers' afterwards.
  void bind_contacts() const;
  void bind_pushes() const;
  /// Binds, for the contact's term, room for pairs that it chooses, and for their energies.
  void bind_term() const;
  void bind_energies() const;

  struct Pair {
    std::array<std::uint32_t, 4> corners{};  ///< a vertex and a triangle, or the ends of two edges
    bool edges = false;
    bool forces = true;  ///< false: side by side, or too near, at rest: not kept apart
  };
  /// The pairs of the last search since `invalidate`. Waits for the GPU.
  std::vector<Pair> read_pairs() const;
  /// False: no search has been made since `invalidate`.
  bool searched() const { return searched_; }

 private:
  bool search(const StateBuffers& state);  ///< false: none was due
  bool search(const gl::TextureBuffer& position, const gl::TextureBuffer& velocity);
  bool make_room(bool within_step);
  float query_of(const SurfaceControl& control) const;
  void forget_pairs(bool within_step = false);  ///< within a step: not how far it has got
  void limit_query(float most);
  /// How many entries the lists of a search have room for.
  struct Capacities {
    std::uint32_t leaf_pairs = 0, bundle_pairs = 0, triangle_pairs = 0, pairs = 0;
    bool operator==(const Capacities&) const = default;
  };
  void make_lists(const Capacities& wanted);
  static std::size_t bytes_of(const Capacities& capacities);
  bool may_have(const Capacities& wanted);
  std::array<const gl::Program*, 10> programs() const;
  bool waits() const { return driven_ || in_pieces_; }

  std::uint32_t vertex_count_ = 0, triangle_count_ = 0;
  Capacities capacity_;
  std::uint32_t most_ = 0;                                         ///< entries that any list may have
  float most_query_ = 0, widest_query_ = 0, narrowest_query_ = 0;  ///< [m]
  std::shared_ptr<ListMemory> memory_;                             ///< null: the lists are not bounded by it
  std::size_t begun_bytes_ = 0;        ///< of the lists at first, which are known of the scene
  MemoryBudget::Reservation grown_{};  ///< of what they have beyond that
  bool no_memory_ = false;             ///< the last time that a list had to be longer
  bool no_room_ = false;  ///< the last look found that no search can do with lists of `most_` entries
  bool driven_ = false, in_pieces_ = false, searched_ = false;
  gl::AnswersAtOnce answers_;  ///< to none(groups)
  std::uint64_t updates_ = 0;  ///< calls of `update` since `invalidate`
  gl::Program triangle_boxes_program_, boxes_program_, leaf_pairs_program_, bundle_pairs_program_,
      triangle_pairs_program_, neighbours_, candidates_, pairs_program_, rest_, finish_;
  SurfaceBlocks blocks_;
  gl::Buffer control_;
  gl::ReadbackRing sizes_ring_;
  gl::TextureBuffer triangles_, rest_places_, neighbour_pairs_, triangle_boxes_, boxes_, leaf_pairs_,
      bundle_pairs_, triangle_pairs_, pairs_, near_pairs_, chosen_pairs_, pair_loads_, contact_links_,
      contact_pushes_;
  gl::TextureBuffer expected_;
};

}  // namespace clothlab::sim
