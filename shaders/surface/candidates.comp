// Pair search, 4 of 6: the vertices and triangles, and the edges, of two triangles that are near each other, if their
// boxes are near. Each vertex and edge is owned by one of its triangles, so that no pair is found twice (Curtis et al.
// 2008, "Fast Collision Detection for Deformable Models using Representative-Triangles"). Pairs that share a vertex are
// left out.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: bits 0 to 2: owns the vertex; 3 to 5: the edge from it
READ_UVEC2(triangle_pair_list, unit_triangle_pairs);
layout(std430, binding = slot_near_pairs) writeonly buffer Candidates { uvec4 list[]; };  // a pair each

bool boxes_near(vec3 low, vec3 high, vec3 other_low, vec3 other_high, float reach) {
  return all(lessThanEqual(low, other_high + reach)) && all(lessThanEqual(other_low, high + reach));
}

void add(uvec4 pair) {
  uint slot = atomicAdd(candidates, 1u);
  if (slot >= 3u * pair_capacity) return;
  list[slot] = pair;
  atomicMax(candidate_groups, slot / uint(GROUP_SIZE) + 1u);
}

/// The vertices that a triangle owns, against another triangle.
void add_vertices(uvec4 from, vec3 x[3], uvec4 to, vec3 y[3], float reach) {
  vec3 low = min(y[0], min(y[1], y[2])), high = max(y[0], max(y[1], y[2]));
  for (int k = 0; k < 3; ++k) {
    uint vertex = from[k];
    bool owned = (from.w >> k & 1u) != 0u && vertex != to.x && vertex != to.y && vertex != to.z;
    RARELY(owned && boxes_near(x[k], x[k], low, high, reach)) add(uvec4(vertex, to.xyz));
  }
}

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(triangle_pairs, triangle_pair_capacity)) return;
  uvec2 both = FETCH_UVEC2(triangle_pair_list, item);
  uvec4 one = FETCH(surface_triangles, both.x), other = FETCH(surface_triangles, both.y);
  vec3 x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    x[k] = FETCH(position, one[k]).xyz;
    y[k] = FETCH(position, other[k]).xyz;
  }
  float reach = reach_of(next_query());
  add_vertices(one, x, other, y, reach);
  add_vertices(other, y, one, x, reach);
  for (int m = 0; m < 3; ++m) {
    int m_end = (m + 1) % 3;
    vec3 low = min(x[m], x[m_end]), high = max(x[m], x[m_end]);
    bool owned = (one.w >> (3 + m) & 1u) != 0u;
    for (int n = 0; n < 3; ++n) {
      int n_end = (n + 1) % 3;
      uvec4 c = uvec4(one[m], one[m_end], other[n], other[n_end]);
      bool apart = c.x != c.z && c.x != c.w && c.y != c.z && c.y != c.w;
      RARELY(owned && apart && (other.w >> (3 + n) & 1u) != 0u &&
             boxes_near(low, high, min(y[n], y[n_end]), max(y[n], y[n_end]), reach))
        add(uvec4(c.x | edges_bit, c.yzw));
    }
  }
}
