// Pair search, 6 of 7: the pairs that are near each other, not their boxes alone. They come from the candidates, and
// from triangles that share a vertex: what can meet there is known beforehand, and most of it is never near.
#include "surface.glsl"
#include "reach.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
READ_UVEC4(candidate_list, unit_near_pairs);
READ_UVEC4(neighbour_pairs, unit_neighbour_pairs);
layout(std430, binding = slot_surface_pairs) writeonly buffer Pairs { uvec4 list[]; };

/// True if two parts of one cloth are nearer to each other at rest than the thickness.
bool near_at_rest(bool edges, uvec4 corner) {
  vec4 origin = FETCH(rest_position, corner.x);
  Corners c;
  bool one_cloth = all(lessThan(corner, uvec4(cloth_vertex_count)));
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(rest_position, corner[k]);
    one_cloth = one_cloth && x.w == origin.w;
    c.x[k] = x.xyz - origin.xyz;
  }
  return one_cloth && separation(edges, c).gap < thickness;
}

void main() {
  int item = int(gl_GlobalInvocationID.x), candidate = item - neighbour_pair_count;
  if (candidate >= int(min(known.candidates, 3u * pair_capacity))) return;
  uvec4 pair = candidate < 0 ? FETCH(neighbour_pairs, item) : FETCH(candidate_list, candidate);
  uvec4 corner = corners_of(pair);
  bool edges = is_edges(pair), flat_at_rest = (pair.y & no_force_bit) != 0u;
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c;
  for (int k = 0; k < 4; ++k) c.x[k] = FETCH(position, corner[k]).xyz - origin;
  RARELY(within_reach(edges, c, reach) && separation(edges, c).gap < reach) {
    uint slot = atomicAdd(control.pairs, 1u);
    if (slot < pair_capacity) {
      if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.pair_groups, slot / uint(GROUP_SIZE) + 1u);
      if (!flat_at_rest && near_at_rest(edges, corner)) pair.y |= no_force_bit;
      list[slot] = pair;
    }
  }
}
