// Pair search, 6 of 7: the pairs that are near each other, not their boxes alone. They come from the candidates, and
// from triangles that share a vertex: what can meet there is known beforehand, and most of it is never near.
#include "surface.glsl"
#include "reach.glsl"
#include "triangles.glsl"
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

/// Of a pair by its number (candidates.comp): a corner k of both triangles, 3 to 5 of the second. A vertex, and a
/// triangle n, n + 1, n + 2; or edges m to m_end and n to n_end.
ivec4 corners_by_number(int number) {
  bool edges = number >= 6;
  int m = edges ? number / 3 - 2 : number, n = edges ? 3 + number % 3 : number < 3 ? 3 : 0;
  return edges ? ivec4(m, (m + 1) % 3, n, 3 + (n - 2) % 3) : ivec4(m, n, n + 1, n + 2);
}

uvec4 candidate_pair(int item, out vec3 place[4]) {
  uvec4 candidate = FETCH(candidate_list, item);
  ivec4 corner = corners_by_number(int(candidate.z));
  uvec4 pair;
  for (int k = 0; k < 4; ++k) {
    uvec4 texel = FETCH(triangle_corners, corner[k] < 3 ? 3u * candidate.x + uint(corner[k])
                                                        : 3u * candidate.y + uint(corner[k] - 3));
    place[k] = uintBitsToFloat(texel.xyz);
    pair[k] = texel.w & number_mask;
  }
  if (candidate.z >= 6u) pair.x |= edges_bit;
  pair.y |= candidate.w;
  return pair;
}

uvec4 pair_of_neighbours(int item, out vec3 place[4]) {
  uvec4 pair = FETCH(neighbour_pairs, item), corner = corners_of(pair);
  for (int k = 0; k < 4; ++k) place[k] = FETCH(position, corner[k]).xyz;
  return pair;
}

void main() {
  int item = int(gl_GlobalInvocationID.x), candidate = item - neighbour_pair_count;
  if (candidate >= int(min(known.candidates, 3u * pair_capacity))) return;
  Corners c;
  uvec4 pair;
  RARELY(candidate < 0) pair = pair_of_neighbours(item, c.x);
  RARELY(candidate >= 0) pair = candidate_pair(candidate, c.x);
  bool edges = is_edges(pair), flat_at_rest = (pair.y & no_force_bit) != 0u;
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  vec3 origin = c.x[0];
  for (int k = 0; k < 4; ++k) c.x[k] -= origin;
  RARELY(within_reach(edges, c, reach) && separation(edges, c).gap < reach) {
    uint slot = atomicAdd(control.pairs, 1u);
    if (slot < pair_capacity) {
      if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.pair_groups, slot / uint(GROUP_SIZE) + 1u);
      if (!flat_at_rest && near_at_rest(edges, corners_of(pair))) pair.y |= no_force_bit;
      list[slot] = pair;
    }
  }
}
