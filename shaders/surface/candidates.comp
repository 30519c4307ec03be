// Pair search, 7 of 10: which vertices and triangles, and which edges, of two triangles that are near each other have
// boxes that are near. Each vertex and edge is owned by one of its triangles, so that no pair is found twice (Curtis et
// al. 2008, "Fast Collision Detection for Deformable Models using Representative-Triangles").
#include "surface.glsl"
#include "triangles.glsl"
#include "boxes.glsl"
READ_UVEC2(triangle_pair_list, unit_triangle_pairs);
layout(std430, binding = slot_near_pairs) writeonly buffer Candidates { uvec4 list[]; };  // pairs

/// The pairs that two triangles own, as bits: 0 to 2 a vertex of the first and the second, 3 to 5 a vertex of the
/// second and the first, 6 to 14 an edge of each.
uint owned_pairs(uvec3 one, uvec3 other) {
  uvec3 vertex = one >> 31u, other_vertex = other >> 31u, edge = one >> 30u & 1u, other_edge = other >> 30u & 1u;
  uint edges = other_edge.x | other_edge.y << 1u | other_edge.z << 2u;
  return vertex.x | vertex.y << 1u | vertex.z << 2u | other_vertex.x << 3u | other_vertex.y << 4u |
         other_vertex.z << 5u | edges * (edge.x << 6u | edge.y << 9u | edge.z << 12u);
}

/// The pairs whose boxes are near, as the same bits. Loops of constant length over constant numbers: the places stay in
/// registers.
uint near_pairs(vec3 one[3], vec3 other[3], float reach) {
  float most = reach * reach;
  uint found = 0u;
  vec3 low = min(one[0], min(one[1], one[2])), high = max(one[0], max(one[1], one[2]));
  vec3 other_low = min(other[0], min(other[1], other[2])), other_high = max(other[0], max(other[1], other[2]));
  for (int k = 0; k < 3; ++k) {
    if (box_gap_squared(one[k], one[k], other_low, other_high) <= most) found |= 1u << k;
    if (box_gap_squared(other[k], other[k], low, high) <= most) found |= 8u << k;
    vec3 end = one[(k + 1) % 3], edge_low = min(one[k], end), edge_high = max(one[k], end);
    for (int m = 0; m < 3; ++m) {
      vec3 other_end = other[(m + 1) % 3];
      if (box_gap_squared(edge_low, edge_high, min(other[m], other_end), max(other[m], other_end)) <= most)
        found |= 64u << (3 * k + m);
    }
  }
  return found;
}

/// A corner of two triangles, 3 to 5 of the second.
uint corner(uvec2 both, int k) {
  return FETCH(triangle_corners, k < 3 ? 3u * both.x + uint(k) : 3u * both.y + uint(k - 3)).w & number_mask;
}

/// The pair of two triangles of one of the bits: a vertex, and a triangle n, n + 1, n + 2; or edges m to m_end and n to
/// n_end.
uvec4 pair_of_bit(uvec2 both, int bit) {
  bool edges = bit >= 6;
  int m = edges ? bit / 3 - 2 : bit, n = edges ? 3 + bit % 3 : bit < 3 ? 3 : 0;
  uvec4 pair = uvec4(corner(both, m), corner(both, edges ? (m + 1) % 3 : n), corner(both, edges ? n : n + 1),
                     corner(both, edges ? 3 + (n - 2) % 3 : n + 2));
  if (edges) pair.x |= edges_bit;
  return pair;
}

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.triangle_pairs, triangle_pair_capacity)) return;
  uvec2 both = FETCH_UVEC2(triangle_pair_list, item);
  bool flat_at_rest = (both.y & flat_bit) != 0u;
  both.y &= ~flat_bit;
  Triangle one = triangle_at(int(both.x)), other = triangle_at(int(both.y));
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  vec3 origin = one.x[0];
  for (int k = 0; k < 3; ++k) {
    one.x[k] -= origin;
    other.x[k] -= origin;
  }
  uint left = owned_pairs(one.tags, other.tags) & near_pairs(one.x, other.x, reach);
  if (left != 0u) {
    uint slot = atomicAdd(control.candidates, uint(bitCount(left)));
    uint end = min(slot + uint(bitCount(left)), 3u * pair_capacity);
    if (slot < end) atomicMax(control.candidate_groups, (end - 1u) / uint(GROUP_SIZE) + 1u);
    for (; slot < end; left &= left - 1u, ++slot) {
      uvec4 pair = pair_of_bit(both, findLSB(left));
      if (flat_at_rest) pair.y |= no_force_bit;
      list[slot] = pair;
    }
  }
}
