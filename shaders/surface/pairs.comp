// Pair search, 8 of 10: the candidates that are near each other, not their boxes alone.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_UVEC4(candidate_list, unit_near_pairs);
layout(std430, binding = slot_surface_pairs) writeonly buffer Pairs { uvec4 list[]; };

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.candidates, 3u * pair_capacity)) return;
  uvec4 pair = FETCH(candidate_list, item), corner = corners_of(pair);
  bool edges = is_edges(pair), flat_at_rest = (pair.y & no_force_bit) != 0u;
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c;
  for (int k = 0; k < 4; ++k) c.x[k] = FETCH(position, corner[k]).xyz - origin;
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  if (separation(edges, c).gap < reach) {
    uint slot = atomicAdd(control.pairs, 1u);
    if (slot < pair_capacity) {
      if (slot % uint(GROUP_SIZE) == 0u) {
        atomicMax(control.pair_groups, slot / uint(GROUP_SIZE) + 1u);
        atomicMax(control.rest_groups, slot / uint(GROUP_SIZE) + 1u);
      }
      list[slot] = pair;
    }
  }
}
