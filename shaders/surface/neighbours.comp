// Pair search, 6 of 10: the candidates of triangles that share a vertex. What can meet there is known beforehand, and
// most of it is never near.
#include "surface.glsl"
#include "reach.glsl"
#include "expected.glsl"
READ_UVEC4(neighbour_pairs, unit_neighbour_pairs);
layout(std430, binding = slot_near_pairs) writeonly buffer Candidates { uvec4 list[]; };

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item >= neighbour_pair_count) return;
  uvec4 pair = FETCH(neighbour_pairs, item), corner = corners_of(pair);
  vec3 origin = place_at_search(corner.x);
  Corners c, ahead;
  for (int k = 0; k < 4; ++k) {
    c.x[k] = place_at_search(corner[k]) - origin;
    ahead.x[k] = c.x[k] + expected_motion(corner[k]);
  }
  bool flat_at_rest = (pair.y & no_force_bit) != 0u;
  if (within_reach(is_edges(pair), c, ahead, reach_of(flat_at_rest ? next_flat_query() : next_query()))) {
    uint slot = atomicAdd(control.candidates, 1u);
    if (slot < 3u * pair_capacity) {
      if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.candidate_groups, slot / uint(GROUP_SIZE) + 1u);
      list[slot] = pair;
    }
  }
}
