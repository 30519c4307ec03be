// Keeps the neighbour lists that self-collision reads. A few dispatches rebuild them, only in a step in which
// a vertex has moved half the skin since the last rebuild. The GPU itself finds that out (indirect dispatch),
// so the host neither waits nor guesses. The search is dispatched in ranges of vertices, each short enough
// that a step can stop between two of them.
#pragma once

#include "server/base/result.h"
#include "server/gl/buffer.h"
#include "server/gl/program.h"
#include "server/gl/software/software.h"
#include "server/model/model.h"
#include "server/scene/scene.h"
#include "server/sim/carried.h"
#include "server/sim/work.h"

namespace clothlab::sim {

/// Length of each neighbour list at the start of a run: NEIGHBOUR_SLOTS in shaders/collide/neighbours.glsl.
inline constexpr std::uint32_t neighbour_slots = 64;

class SelfCollision {
 public:
  static Result<SelfCollision> create(const model::Model& model, std::uint32_t slots = neighbour_slots);

  /// Sets the distances for a scene; the lists are rebuilt before the next step. Error: so many vertices
  /// start within reach of each other that a search would take too long.
  Status set_parameters(const scene::SelfCollision& parameters, const model::Model& model);

  /// Number of other vertices that the search looks at for one vertex: the mean over a sample of the
  /// vertices, at their start positions.
  double candidates() const { return candidates_; }

  /// Rebuilds the lists if a vertex has moved too far since the last rebuild. Positions and rest positions
  /// must be bound; leaves the buffers of the lists bound for the step kernels. Every few updates, at a fixed
  /// count and not by time, reads back how long the lists need to be.
  Work update_lists();
  /// Number of slots that each list should have, by the length last read back: the present number if that is
  /// enough, or if more would take too much memory or time. In that case a neighbour that finds no slot is
  /// left out of the lists of both vertices, and counted in `dropped`.
  std::uint32_t slots_needed() const;
  std::uint32_t slots() const { return slots_; }
  /// Takes over the counts of `other`, which this object replaces because it has more slots.
  void take_counters(const SelfCollision& other);
  /// Has the lists rebuilt before the next step, however far vertices have moved.
  void invalidate();
  /// Makes the lists those that a step given up has begun with: it is about to begin again.
  void give_up_step();
  /// To be called when a step has ended: the next one brings the lists up to date anew.
  void end_step() { updated_ = false; }
  /// Names the lists and when they were made. They are found again from the places at which the search was
  /// made, so rest positions must be bound. Waits for the GPU.
  void carry(Carrier& carrier);

  float skin() const { return skin_; }

  struct Neighbour {
    std::uint32_t vertex = 0;
    float distance = 0;  ///< the distance that self-collision keeps from that vertex [m]
    bool operator==(const Neighbour&) const = default;
  };
  /// The present list of each vertex, nearest neighbour first; none before the first search since
  /// `invalidate`. Waits for the GPU.
  std::vector<std::vector<Neighbour>> read_lists() const;
  float reach() const { return reach_; }

  struct Counters {
    std::uint32_t rebuilds = 0;  ///< how often the lists were built
    std::uint32_t dropped = 0;   ///< neighbours that found no slot in a list, over all rebuilds
    std::uint32_t longest = 0;   ///< longest list needed in any rebuild; 0: no list was over half full
  };
  /// The GPU's buffer with the Counters, at `counters_offset` [bytes], to be copied along with other results.
  const gl::Buffer& control() const { return control_; }
  static constexpr std::size_t counters_offset = 3 * sizeof(std::uint32_t);

 private:
  void bind() const;
  void limit_range(std::uint32_t groups);
  bool search_is_due() const;
  Work search();
  void search_again();
  void read_counters();

  std::uint32_t vertex_count_ = 0, slots_ = neighbour_slots;
  std::uint32_t range_groups_ = 1;  ///< work groups of one dispatch of the search
  double candidates_ = 0;
  std::uint64_t updates_ = 0;  ///< calls of update_lists since `invalidate`
  bool searched_ = false;      ///< since `invalidate`
  bool updated_ = false;       ///< for the step under way
  gl::AnswersAtOnce answers_;  ///< whether a search is due
  std::uint32_t longest_ = 0;  ///< Counters::longest as last read back
  float skin_ = 0;             ///< [m]
  float reach_ = 0;            ///< contact distance + skin: how far the lists look [m]
  gl::Program insert_, find_, finish_;
  gl::Buffer control_;
  gl::ReadbackRing counters_ring_;
  gl::TextureBuffer heads_, chains_, counts_, lists_, built_position_, excluded_, first_excluded_;
};

}  // namespace clothlab::sim
