// Contact between surfaces, after a step of any method (shaders/surface/): pushes that keep triangles and
// edges apart, and a filter that shortens steps so that nothing passes through anything. The pairs that can
// meet come from a search, which the GPU itself asks for when a vertex has moved far enough. All is
// dispatched indirectly: nothing is done for pairs that are not there, and the host does not wait to find
// that out.
#pragma once

#include <array>

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/plan.h"
#include "server/sim/state.h"
#include "server/sim/work.h"

namespace clothlab::sim {

class SurfaceContact {
 public:
  static Result<SurfaceContact> create(const model::Model& model, const Plan& plan);

  /// Takes over the numbers of a scene; the pairs are searched anew before the next step.
  void set_parameters(const scene::Scene& scene, const model::Model& model);

  /// To be called before a step: brings the pairs up to date. Rest positions must be bound. Every few calls,
  /// at a fixed count and not by time, reads back how long the lists need to be, and makes them longer. Until
  /// then nothing moves.
  Work update_pairs(const StateBuffers& state);
  /// To be called after a step: changes the new state so that it keeps apart and nothing has passed through.
  void keep_apart(StateBuffers& state);

  /// Forgets the pairs and what is carried over from step to step.
  void invalidate();

  struct Counters {
    std::uint32_t pairs = 0;     ///< that the last search listed
    std::uint32_t near = 0;      ///< of these, in the last step
    std::uint32_t cuts = 0;      ///< vertices whose steps were shortened, over all steps
    std::uint32_t rebuilds = 0;  ///< searches
  };
  /// Queues a copy of the counts to `bytes_of_counts` of `target`, from `offset`. `read_counts` makes
  /// Counters of them.
  void copy_counts(const gl::Buffer& target, std::size_t offset) const;
  static Counters read_counts(const std::byte* counts);
  static const std::size_t bytes_of_counts;

  struct Pair {
    std::array<std::uint32_t, 4> corners{};  ///< a vertex and a triangle, or the ends of two edges
    bool edges = false;
    bool forces = true;  ///< false: too near at rest to be kept apart
  };
  /// The pairs of the last search. Waits for the GPU.
  std::vector<Pair> read_pairs() const;

 private:
  void search(const StateBuffers& state);
  bool read_sizes();
  void limit_query(float most);
  void make_lists(std::uint32_t triangle_pairs, std::uint32_t pairs);

  std::uint32_t vertex_count_ = 0, triangle_count_ = 0;
  std::uint32_t triangle_pair_capacity_ = 0, pair_capacity_ = 0;
  float most_query_ = 0;       ///< [m]
  std::uint64_t updates_ = 0;  ///< calls of update_pairs since `invalidate`
  int turn_ = 0;
  int push_passes_ = 0;
  bool keeps_start_ = false;  ///< the strain limit writes over the positions at the step's start
  gl::Program boxes_, cells_program_, triangle_pairs_program_, candidates_, pairs_program_, finish_;
  gl::Program contacts_, forces_, apply_, begin_, limit_, move_;
  gl::Buffer control_;
  gl::ReadbackRing sizes_ring_;
  gl::TextureBuffer triangles_, triangle_boxes_, cells_, chains_, triangle_pairs_, pairs_, near_pairs_;
  gl::TextureBuffer built_position_, start_, target_;
  gl::Buffer sums_, limits_;
};

}  // namespace clothlab::sim
