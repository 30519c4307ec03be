// Pair search, 4 of 6: the vertices and triangles, and the edges, of two triangles that are near each other, if their
// boxes are near. Each vertex and edge is owned by one of its triangles, so that no pair is found twice (Curtis et al.
// 2008, "Fast Collision Detection for Deformable Models using Representative-Triangles"). Pairs that share a vertex are
// left out.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: bits 0 to 2: owns the vertex; 3 to 5: the edge from it
READ_UVEC2(triangle_pair_list, unit_triangle_pairs);
layout(std430, binding = slot_near_pairs) writeonly buffer Candidates { uvec4 list[]; };  // a pair each

/// One of the pairs of two triangles: number 0 to 5 a vertex and a triangle, 6 to 14 two edges.
void main() {
  uint item = gl_GlobalInvocationID.x / 16u;
  int number = int(gl_GlobalInvocationID.x % 16u);
  if (item >= min(triangle_pairs, triangle_pair_capacity) || number == 15) return;
  uvec2 both = FETCH_UVEC2(triangle_pair_list, item);
  if (number >= 3 && number < 6) both = both.yx;
  uvec4 one = FETCH(surface_triangles, both.x), other = FETCH(surface_triangles, both.y), c;
  bool edges = number >= 6, owned;
  int m = edges ? number / 3 - 2 : number % 3, n = number % 3;
  if (edges) {
    owned = (one.w >> (3 + m) & 1u) != 0u && (other.w >> (3 + n) & 1u) != 0u;
    c = uvec4(one[m], one[(m + 1) % 3], other[n], other[(n + 1) % 3]);
  } else {
    owned = (one.w >> m & 1u) != 0u;
    c = uvec4(one[m], other.xyz);
  }
  bool shared_vertex =
      c.x == c.z || c.x == c.w || (edges ? c.y == c.z || c.y == c.w : c.x == c.y);
  RARELY(owned && !shared_vertex) {
    vec3 x = FETCH(position, c.x).xyz, y = FETCH(position, c.y).xyz;
    vec3 z = FETCH(position, c.z).xyz, w = FETCH(position, c.w).xyz;
    vec3 low = edges ? min(x, y) : x, high = edges ? max(x, y) : x;
    vec3 other_low = edges ? min(z, w) : min(y, min(z, w)), other_high = edges ? max(z, w) : max(y, max(z, w));
    float reach = reach_of(next_query());
    RARELY(all(lessThanEqual(low, other_high + reach)) && all(lessThanEqual(other_low, high + reach))) {
      uint slot = atomicAdd(candidates, 1u);
      if (slot < 3u * pair_capacity) {
        list[slot] = edges ? uvec4(c.x | edges_bit, c.yzw) : c;
        atomicMax(candidate_groups, slot / uint(GROUP_SIZE) + 1u);
      }
    }
  }
}
