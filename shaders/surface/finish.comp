// Pair search, 6 of 6: empties the hash for the next search, and ends this one until a vertex asks for another.
#include "surface.glsl"
layout(std430, binding = slot_triangle_cells) writeonly buffer Cells { uint heads[]; };

void main() {
  for (uint cell = gl_GlobalInvocationID.x; cell < CELL_COUNT; cell += gl_NumWorkGroups.x * GROUP_SIZE)
    heads[cell] = 0xffffffffu;
  if (gl_GlobalInvocationID.x > 0u) return;
  query = floatBitsToUint(next_query());
  // Candidates are where near pairs will be, with three times the room.
  uint needed = max(pairs, (candidates + 2u) / 3u);
  overflow = triangle_pairs > triangle_pair_capacity || needed > pair_capacity ? 1u : 0u;
  most_triangle_pairs = max(most_triangle_pairs, triangle_pairs);
  most_pairs = max(most_pairs, needed);
  largest_triangle = fastest = fastest_vertex = levels = 0u;
  rebuild_groups = split_groups = candidate_groups = 0u;
  // How many searches it takes to make room depends on which pairs had some: they do not count.
  if (overflow == 0u) ++rebuilds;
}
