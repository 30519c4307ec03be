// Pair search, 4 of 6: the vertices and triangles, and the edges, of two triangles that are near each other, if their
// boxes are near. Each vertex and edge is owned by one of its triangles, so that no pair is found twice (Curtis et al.
// 2008, "Fast Collision Detection for Deformable Models using Representative-Triangles"). Pairs that share a vertex are
// left out.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: bits 0 to 2: owns the vertex; 3 to 5: the edge from it
READ_UVEC2(triangle_pair_list, unit_triangle_pairs);
layout(std430, binding = slot_near_pairs) writeonly buffer Candidates { uvec4 list[]; };  // a pair each

/// The pairs that two triangles own, as bits: 0 to 2 a vertex of the first and the second, 3 to 5 a vertex of the
/// second and the first, 6 to 14 an edge of each.
uint owned_pairs(uint one, uint other) {
  uint edges = other >> 3u & 7u;
  uint both = (one >> 3u & 1u) * edges | (one >> 4u & 1u) * (edges << 3u) | (one >> 5u & 1u) * (edges << 6u);
  return (one & 7u) | (other & 7u) << 3u | both << 6u;
}

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(triangle_pairs, triangle_pair_capacity)) return;
  uvec2 both = FETCH_UVEC2(triangle_pair_list, item);
  bool flat_at_rest = (both.y & flat_bit) != 0u;
  both.y &= ~flat_bit;
  uvec4 one = FETCH(surface_triangles, both.x), other = FETCH(surface_triangles, both.y);
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  vec3 place[6];
  for (int k = 0; k < 3; ++k) {
    place[k] = FETCH(position, one[k]).xyz;
    place[3 + k] = FETCH(position, other[k]).xyz;
  }
  uint vertex[6] = uint[](one.x, one.y, one.z, other.x, other.y, other.z);
  for (uint left = owned_pairs(one.w, other.w); left != 0u; left &= left - 1u) {
    int number = findLSB(left);
    bool edges = number >= 6;
    int m = edges ? number / 3 - 2 : number, n = edges ? 3 + number % 3 : number < 3 ? 3 : 0;
    int m_end = edges ? (m + 1) % 3 : n, n_end = edges ? 3 + (n - 2) % 3 : n + 2, n_first = edges ? n : n + 1;
    // A vertex, and a triangle n, n + 1, n + 2; or edges m to m_end and n to n_end.
    uvec4 c = uvec4(vertex[m], vertex[m_end], vertex[n_first], vertex[n_end]);
    bool one_vertex = c.x == c.z || c.x == c.w || (edges ? c.y == c.z || c.y == c.w : c.x == c.y);
    vec3 x = place[m], y = place[m_end], z = place[n_first], w = place[n_end];
    vec3 low = edges ? min(x, y) : x, high = edges ? max(x, y) : x;
    vec3 other_low = min(edges ? z : y, min(z, w)), other_high = max(edges ? z : y, max(z, w));
    RARELY(!one_vertex && all(lessThanEqual(low, other_high + reach)) &&
           all(lessThanEqual(other_low, high + reach))) {
      uint slot = atomicAdd(candidates, 1u);
      if (slot < 3u * pair_capacity) {
        list[slot] = uvec4(edges ? c.x | edges_bit : c.x, flat_at_rest ? c.y | no_force_bit : c.y, c.zw);
        if (slot % uint(GROUP_SIZE) == 0u) atomicMax(candidate_groups, slot / uint(GROUP_SIZE) + 1u);
      }
    }
  }
}
