// Keeps the neighbour lists that self-collision reads: a few dispatches that run only in the steps in which a
// vertex has moved half the skin, which the GPU finds out by itself (indirect dispatch), so nothing waits and
// nothing is guessed. The search is dispatched in ranges of vertices, short enough to stop between.
#pragma once

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/work.h"

namespace clothlab::sim {

/// Of a vertex's neighbour list, to begin with: NEIGHBOUR_SLOTS in shaders/collide/neighbours.glsl.
inline constexpr std::uint32_t neighbour_slots = 64;

class SelfCollision {
 public:
  static Result<SelfCollision> create(const model::Model& model, std::uint32_t slots = neighbour_slots);

  /// The distances for this scene; the lists are rebuilt before the next step. Error: far too many vertices
  /// start within reach of each other for a search to end in bearable time.
  Status set_parameters(const scene::SelfCollision& parameters, const model::Model& model);

  /// Other vertices that the search looks at for one vertex, in the mean over a sample of the start.
  double candidates() const { return candidates_; }

  /// Rebuilds the lists if a vertex has moved too far since. Needs position and rest
  /// positions bound; leaves bound what the step kernel reads and writes of the lists. Looks now and then, by
  /// the count of updates alone, whether the lists are long enough.
  Work update_lists();
  /// Slots that lists as long as the last look found should have; as many as they have where those will do,
  /// or where more would be too many. What has no room then is left out on both sides, and counted.
  std::uint32_t slots_needed() const;
  std::uint32_t slots() const { return slots_; }
  /// Goes on counting where another one, with fewer slots, was.
  void take_counters(const SelfCollision& other);
  /// Rebuilds them before the next step whatever has moved.
  void invalidate();

  float skin() const { return skin_; }

  struct Neighbour {
    std::uint32_t vertex = 0;
    float distance = 0;  ///< that self-collision keeps [m]
    bool operator==(const Neighbour&) const = default;
  };
  /// Each vertex's list as it is now, nearest first. Waits for the GPU.
  std::vector<std::vector<Neighbour>> read_lists() const;
  float reach() const { return reach_; }

  struct Counters {
    std::uint32_t rebuilds = 0;  ///< how often the lists were built
    std::uint32_t dropped = 0;   ///< neighbours beyond the slots of a list, over all rebuilds
    std::uint32_t longest = 0;   ///< list there would have been, over all rebuilds; 0 up to half of the slots
  };
  /// Where the GPU keeps the counters, to be copied along with other results.
  const gl::Buffer& control() const { return control_; }
  static constexpr std::size_t counters_offset = 3 * sizeof(std::uint32_t);

 private:
  void limit_range(std::uint32_t groups);
  void look();

  std::uint32_t vertex_count_ = 0, slots_ = neighbour_slots;
  std::uint32_t range_groups_ = 1;  ///< work groups of one dispatch of the search
  double candidates_ = 0;
  std::uint64_t updates_ = 0;  ///< since the lists were invalid
  std::uint32_t longest_ = 0;  ///< as last seen
  float skin_ = 0;             ///< [m]
  float reach_ = 0;            ///< contact distance + skin: how far the lists look [m]
  gl::Program insert_, find_, finish_;
  gl::Buffer control_;
  gl::ReadbackRing seen_;
  gl::TextureBuffer heads_, chains_, counts_, lists_, built_position_, excluded_, first_excluded_;
};

}  // namespace clothlab::sim
