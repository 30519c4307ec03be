// Pair search, 7 of 10: which vertices and triangles, and which edges, of two triangles that are near each other have
// boxes that are near. Each vertex and edge is owned by one of its triangles, so that no pair is found twice (Curtis et
// al. 2008, "Fast Collision Detection for Deformable Models using Representative-Triangles").
#include "surface.glsl"
#include "triangles.glsl"
#include "expected.glsl"
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

/// Where the corners of a triangle are, and where they will be.
struct Paths {
  vec3 x[3], ahead[3];
};

Paths paths_of(uvec3 tags) {
  Paths p;
  for (int k = 0; k < 3; ++k) {
    uint vertex = tags[k] & number_mask;
    p.x[k] = place_at_search(vertex);
    p.ahead[k] = p.x[k] + expected_motion(vertex);
  }
  return p;
}

Box box_of_vertex(Paths p, int k) { return Box(p.x[k], p.x[k], p.ahead[k], p.ahead[k]); }

Box box_of_edge(Paths p, int k) {
  int end = (k + 1) % 3;
  return Box(min(p.x[k], p.x[end]), max(p.x[k], p.x[end]), min(p.ahead[k], p.ahead[end]),
             max(p.ahead[k], p.ahead[end]));
}

/// The pairs whose boxes are near, as the same bits. Loops of constant length over constant numbers: the places stay in
/// registers.
uint near_pairs(Triangle one, Triangle other, float reach) {
  float most = reach * reach;
  uint found = 0u;
  Paths paths = paths_of(one.tags), other_paths = paths_of(other.tags);
  for (int k = 0; k < 3; ++k) {
    if (box_gap_squared(box_of_vertex(paths, k), other.box) <= most) found |= 1u << k;
    if (box_gap_squared(box_of_vertex(other_paths, k), one.box) <= most) found |= 8u << k;
    Box edge = box_of_edge(paths, k);
    for (int m = 0; m < 3; ++m)
      if (box_gap_squared(edge, box_of_edge(other_paths, m)) <= most) found |= 64u << (3 * k + m);
  }
  return found;
}

/// A corner of two triangles, 3 to 5 of the second.
uint corner(uvec2 both, int k) {
  return FETCH(triangle_boxes, k < 3 ? 4u * both.x + uint(k) : 4u * both.y + uint(k - 3)).w & number_mask;
}

/// The pair that bit number `bit` of the two triangles `both` stands for. Below 6: a vertex m and a triangle n, n + 1,
/// n + 2; else an edge m to m_end and an edge n to n_end.
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
  uint left = owned_pairs(one.tags, other.tags) & near_pairs(one, other, reach);
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
