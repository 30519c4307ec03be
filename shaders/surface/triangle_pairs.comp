// Pair search, 4 of 9: pairs of triangles of two near leaves whose boxes are near each other, but for triangles that
// share a vertex (neighbours.comp). Those that lie side by side at rest would all be near each other in a fine mesh:
// the search does not reach as far for them.
#include "surface.glsl"
#include "triangles.glsl"
READ_VEC4(leaf_boxes, unit_leaf_boxes);
READ_UVEC2(leaf_pair_list, unit_leaf_pairs);
READ_VEC4(rest_places, unit_rest_places);  // middle of a triangle's box, cloth; normal, radius about the middle
layout(std430, binding = slot_triangle_pairs) writeonly buffer TrianglePairs { uvec2 found[]; };

uniform int cloth_pairs;  // 0: cloths meet bodies alone

/// Triangles of the first leaf that a thread looks at together: they share what it reads of the second's.
const int together = TOGETHER;

struct RestPlace {
  vec4 middle, normal;
};

RestPlace rest_place(int i) { return RestPlace(FETCH(rest_places, 2 * i), FETCH(rest_places, 2 * i + 1)); }

bool side_by_side_at_rest(RestPlace one, RestPlace other) {
  vec3 between = other.middle.xyz - one.middle.xyz;
  float distance = length(between), flat_enough = OUT_OF_PLANE * distance;
  return one.middle.w == other.middle.w &&
         distance - one.normal.w - other.normal.w < reach_of(1.2 * thickness) &&
         abs(dot(one.normal.xyz, between)) <= flat_enough && abs(dot(other.normal.xyz, between)) <= flat_enough;
}

bool share_vertex(uvec3 one, uvec3 other) {
  return any(equal(one, other)) || any(equal(one, other.yzx)) || any(equal(one, other.zxy));
}

float apart(vec3 low, vec3 high, vec3 other_low, vec3 other_high) {
  vec3 gaps = max(other_low - high, low - other_high);
  return max(gaps.x, max(gaps.y, gaps.z));
}

void keep(int i, int j, bool flat_at_rest) {
  uint slot = atomicAdd(control.triangle_pairs, 1u);
  if (slot >= triangle_pair_capacity) return;
  found[slot] = uvec2(i, flat_at_rest ? uint(j) | flat_bit : uint(j));
  if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.split_groups, slot / uint(GROUP_SIZE) + 1u);
}

void keep_if_near(int i, int j, float flat_reach) {
  bool flat_at_rest = side_by_side_at_rest(rest_place(i), rest_place(j));
  Triangle one = triangle_at(i), other = triangle_at(j);
  if (!flat_at_rest || apart(low_of(one), high_of(one), low_of(other), high_of(other)) <= flat_reach)
    keep(i, j, flat_at_rest);
}

void main() {
  int item = int(gl_GlobalInvocationID.x) * together / LEAF_SIZE;
  if (item >= int(min(known.leaf_pairs, leaf_pair_capacity))) return;
  uvec2 leaves = FETCH_UVEC2(leaf_pair_list, item);
  float reach = reach_of(next_query()), flat_reach = reach_of(next_flat_query());
  vec3 low[together], high[together], group_low = vec3(1e30), group_high = vec3(-1e30);
  uvec3 numbers[together];
  int begin = LEAF_SIZE * int(leaves.x) + int(gl_GlobalInvocationID.x) * together % LEAF_SIZE;
  for (int k = 0; k < together; ++k) {
    Triangle t = triangle_at(min(begin + k, triangle_count - 1));
    low[k] = low_of(t);
    high[k] = high_of(t);
    numbers[k] = t.tags & number_mask;
    group_low = min(group_low, low[k]);
    group_high = max(group_high, high[k]);
  }
  int first = LEAF_SIZE * int(leaves.y), end = min(first + LEAF_SIZE, triangle_count);
  if (leaves.x == leaves.y) first = begin + 1;
  bool near_leaf = apart(group_low, group_high, FETCH(leaf_boxes, 2 * int(leaves.y)).xyz,
                         FETCH(leaf_boxes, 2 * int(leaves.y) + 1).xyz) <= reach;
  // First comparisons of boxes, then what few of them leave: threads that run together seldom leave the same.
  const int at_once = 32 / together;
  for (int some = near_leaf ? LEAF_SIZE * int(leaves.y) : end; some < end; some += at_once) {
    uint near = 0u;
    for (int j = max(some, first); j < min(some + at_once, end); ++j) {
      Triangle t = triangle_at(j);
      vec3 other_low = low_of(t), other_high = high_of(t);
      for (int k = 0; k < together; ++k) {
        int bodies = int(begin + k >= cloth_triangle_count) + int(j >= cloth_triangle_count);
        bool meet = bodies == 1 || (bodies == 0 && cloth_pairs != 0), once = leaves.x != leaves.y || begin + k < j;
        if (apart(low[k], high[k], other_low, other_high) <= reach && begin + k < triangle_count && meet && once &&
            !share_vertex(numbers[k], t.tags & number_mask))
          near |= 1u << (together * (j - some) + k);
      }
    }
    for (; near != 0u; near &= near - 1u) {
      int number = findLSB(near);
      keep_if_near(begin + number % together, some + number / together, flat_reach);
    }
  }
}
