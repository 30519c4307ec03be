// What the passes of contact between surfaces share on the GPU, as shaders/surface/surface.glsl lays it out:
// arguments of indirect dispatches, and what they found.
#pragma once

#include <array>
#include <cstdint>

namespace clothlab::sim {

/// Work groups of an indirect dispatch.
using DispatchGroups = std::array<std::uint32_t, 3>;

/// Of a step; steps take turns with two of them.
struct StepCounts {
  DispatchGroups kept_groups{0, 1, 1}, near_groups{0, 1, 1}, vertex_groups{0, 1, 1}, touching_groups{0, 1, 1},
      pushed_groups{0, 1, 1}, meeting_groups{0, 1, 1}, cut_vertices{0, 1, 1};
  std::uint32_t near = 0, touching = 0, meeting = 0, cuts = 0, touched = 0, kept = 0, unused = 0;
};

struct SurfaceControl {
  std::array<StepCounts, 2> step_counts;
  DispatchGroups rebuild{0, 1, 1}, leaf_groups{0, 1, 1}, bundle_groups{0, 1, 1}, split{0, 1, 1},
      pair_groups{0, 1, 1};
  DispatchGroups neighbour_groups{0, 1, 1}, candidate_groups{0, 1, 1}, check{1, 1, 1},
      contact_groups{0, 1, 1};
  DispatchGroups rest{0, 1, 1}, finish{0, 1, 1};
  std::uint32_t leaf_pairs = 0, bundle_pairs = 0, triangle_pairs = 0, candidates = 0, pairs = 0;
  std::uint32_t fastest = 0, fastest_vertex = 0;
  std::uint32_t query = 0, flat_query = 0, overflow = 0;
  std::uint32_t rebuilds = 0, cuts = 0, forced = 0, not_taken = 0, most_leaf_pairs = 0, most_bundle_pairs = 0,
                most_triangle_pairs = 0, most_pairs = 0;
  float longest = 0.0f, longest_of_bodies = 0.0f, gone = 0.0f, part = 1.0f;
  float skin = 0.0f, next_skin = 0.0f;
  float ahead = 0.0f, next_ahead = 0.0f, since = 0.0f;
  std::uint32_t checks = 0;
};

}  // namespace clothlab::sim
