// Pair search, 4 of 5: the vertices and triangles, and the edges, of two triangles that are near each other. Each vertex
// and edge is owned by one of its triangles, so that no pair is listed twice (Curtis et al. 2008, "Fast Collision
// Detection for Deformable Models using Representative-Triangles"). Pairs that share a vertex are left out.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: bits 0 to 2: owns the vertex; 3 to 5: the edge from it
READ_UVEC2(triangle_pair_list, unit_triangle_pairs);
layout(std430, binding = slot_surface_pairs) writeonly buffer Pairs { uvec4 list[]; };

Corners places(uvec4 corner) {
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c;
  c.x[0] = vec3(0.0);
  for (int k = 1; k < 4; ++k) c.x[k] = FETCH(position, corner[k]).xyz - origin;
  return c;
}

/// True if two parts of one cloth are nearer to each other at rest than the thickness.
bool near_at_rest(bool edges, uvec4 corner) {
  vec4 origin = FETCH(rest_position, corner.x);
  Corners c;
  c.x[0] = vec3(0.0);
  for (int k = 1; k < 4; ++k) {
    vec4 x = FETCH(rest_position, corner[k]);
    if (x.w != origin.w) return false;
    c.x[k] = x.xyz - origin.xyz;
  }
  return separation(edges, c).gap < thickness;
}

void consider(bool edges, uvec4 corner, float reach) {
  if (separation(edges, places(corner)).gap >= reach) return;
  uint slot = atomicAdd(pairs, 1u);
  if (slot >= pair_capacity) return;
  atomicMax(pair_groups, slot / uint(GROUP_SIZE) + 1u);
  uvec4 pair = corner;
  if (edges) pair.x |= edges_bit;
  if (near_at_rest(edges, corner)) pair.y |= no_force_bit;
  list[slot] = pair;
}

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(triangle_pairs, triangle_pair_capacity)) return;
  uvec2 both = FETCH_UVEC2(triangle_pair_list, item);
  uvec4 one = FETCH(surface_triangles, both.x), other = FETCH(surface_triangles, both.y);
  float reach = reach_of(next_query());
  for (int k = 0; k < 6; ++k) {
    uvec4 from = k < 3 ? one : other, to = k < 3 ? other : one;
    uint vertex = from[k % 3];
    bool owned = (from.w >> (k % 3) & 1u) != 0u;
    RARELY(owned && vertex != to.x && vertex != to.y && vertex != to.z)
      consider(false, uvec4(vertex, to.xyz), reach);
  }
  for (int k = 0; k < 9; ++k) {
    int m = k / 3, n = k % 3;
    uvec4 corner = uvec4(one[m], one[(m + 1) % 3], other[n], other[(n + 1) % 3]);
    bool owned = (one.w >> (3 + m) & 1u) != 0u && (other.w >> (3 + n) & 1u) != 0u;
    RARELY(owned && corner.x != corner.z && corner.x != corner.w && corner.y != corner.z && corner.y != corner.w)
      consider(true, corner, reach);
  }
}
