// Pair search, 4 of 7: pairs of triangles of two near leaves whose boxes are near each other, but for triangles that
// share a vertex (pairs.comp). Those that lie side by side at rest would all be near each other in a fine mesh: the
// search does not reach as far for them.
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

void main() {
  int item = int(gl_GlobalInvocationID.x) * together / LEAF_SIZE;
  if (item >= int(min(known.leaf_pairs, leaf_pair_capacity))) return;
  uvec2 leaves = FETCH_UVEC2(leaf_pair_list, item);
  float reach = reach_of(next_query()), flat_reach = reach_of(next_flat_query());
  vec3 low[together], high[together], group_low = vec3(1e30), group_high = vec3(-1e30);
  uvec3 numbers[together];
  RestPlace rest[together];
  int begin = LEAF_SIZE * int(leaves.x) + int(gl_GlobalInvocationID.x) * together % LEAF_SIZE;
  for (int k = 0; k < together; ++k) {
    Triangle t = triangle_at(min(begin + k, triangle_count - 1));
    low[k] = low_of(t);
    high[k] = high_of(t);
    numbers[k] = t.tags & number_mask;
    rest[k] = rest_place(min(begin + k, triangle_count - 1));
    group_low = min(group_low, low[k]);
    group_high = max(group_high, high[k]);
  }
  int first = LEAF_SIZE * int(leaves.y), end = min(first + LEAF_SIZE, triangle_count);
  if (leaves.x == leaves.y) first = begin + 1;
  bool near_leaf = apart(group_low, group_high, FETCH(leaf_boxes, 2 * int(leaves.y)).xyz,
                         FETCH(leaf_boxes, 2 * int(leaves.y) + 1).xyz) <= reach;
  for (int j = near_leaf ? first : end; j < end; ++j) {
    Triangle t = triangle_at(j);
    vec3 other_low = low_of(t), other_high = high_of(t);
    float far[together];
    bool near[together], any_near = false;
    for (int k = 0; k < together; ++k) {
      far[k] = apart(low[k], high[k], other_low, other_high);
      int bodies = int(begin + k >= cloth_triangle_count) + int(j >= cloth_triangle_count);
      bool meet = bodies == 1 || (bodies == 0 && cloth_pairs != 0), once = leaves.x != leaves.y || begin + k < j;
      near[k] = far[k] <= reach && begin + k < triangle_count && meet && once &&
                !share_vertex(numbers[k], t.tags & number_mask);
      any_near = any_near || near[k];
    }
    RARELY(any_near) {
      RestPlace other_rest = rest_place(j);
      for (int k = 0; k < together; ++k) {
        RARELY(near[k]) {
          bool flat_at_rest = side_by_side_at_rest(rest[k], other_rest);
          if (!flat_at_rest || far[k] <= flat_reach) keep(begin + k, j, flat_at_rest);
        }
      }
    }
  }
}
