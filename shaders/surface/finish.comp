// Pair search, 6 of 6: empties the hash for the next search, and ends this one until a vertex asks for another.
#include "surface.glsl"
layout(std430, binding = slot_triangle_cells) writeonly buffer Cells { uint heads[]; };

void main() {
  for (uint cell = gl_GlobalInvocationID.x; cell < CELL_COUNT; cell += gl_NumWorkGroups.x * GROUP_SIZE)
    heads[cell] = 0xffffffffu;
  if (gl_GlobalInvocationID.x > 0u) return;
  query = floatBitsToUint(next_query());
  flat_query = floatBitsToUint(next_flat_query());
  // Candidates are where near pairs will be, with three times the room. What was found beyond a list's room was not
  // searched further, and what was depends on the order of threads: then only what is complete counts.
  uint room_for_candidates = (candidates + 2u) / 3u;
  bool all_triangles = triangle_pairs <= triangle_pair_capacity;
  bool all_candidates = all_triangles && room_for_candidates <= pair_capacity;
  uint needed = all_candidates ? max(pairs, room_for_candidates) : all_triangles ? room_for_candidates : 0u;
  overflow = all_candidates && pairs <= pair_capacity ? 0u : 1u;
  if (overflow != 0u) pairs = pair_groups = 0u;  // a part of the pairs must not push: nothing moves in this step
  most_triangle_pairs = max(most_triangle_pairs, triangle_pairs);
  most_pairs = max(most_pairs, needed);
  largest_triangle = fastest = fastest_vertex = levels = 0u;
  rebuild_groups = split_groups = candidate_groups = 0u;
  ++rebuilds;
}
