// Pair search, 5 of 10: pairs of triangles of two near bundles whose boxes are near each other, but for triangles that
// share a vertex (neighbours.comp). Those that lie side by side at rest would all be near each other in a fine mesh:
// the search does not reach as far for them.
#include "surface.glsl"
#include "triangles.glsl"
READ_UVEC2(bundle_pair_list, unit_bundle_pairs);
READ_VEC4(rest_places, unit_rest_places);  // middle of a triangle's box, cloth; normal, radius about the middle
layout(std430, binding = slot_triangle_pairs) writeonly buffer TrianglePairs { uvec2 found[]; };

uniform int cloth_pairs;  // 0: cloths meet bodies alone

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

void keep(int i, int j, bool flat_at_rest) {
  uint slot = atomicAdd(control.triangle_pairs, 1u);
  if (slot >= triangle_pair_capacity) return;
  found[slot] = uvec2(i, flat_at_rest ? uint(j) | flat_bit : uint(j));
  if (slot % uint(GROUP_SIZE) == 0u) atomicMax(control.split_groups, slot / uint(GROUP_SIZE) + 1u);
}

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item >= int(min(known.bundle_pairs, bundle_pair_capacity))) return;
  uvec2 bundles = FETCH_UVEC2(bundle_pair_list, item);
  float reach = reach_of(next_query()), flat_reach = reach_of(next_flat_query());
  Box box[BUNDLE_SIZE];
  uvec3 numbers[BUNDLE_SIZE];
  int begin = BUNDLE_SIZE * int(bundles.x), other_begin = BUNDLE_SIZE * int(bundles.y);
  for (int k = 0; k < BUNDLE_SIZE; ++k) {
    Triangle t = triangle_at(min(begin + k, triangle_count - 1));
    box[k] = t.box;
    numbers[k] = t.tags & number_mask;
  }
  // First comparisons of boxes, then what few of them leave: threads that run together seldom leave the same.
  uint near = 0u, very_near = 0u;
  for (int m = 0; m < BUNDLE_SIZE; ++m) {
    int j = other_begin + m;
    Triangle t = triangle_at(min(j, triangle_count - 1));
    for (int k = 0; k < BUNDLE_SIZE; ++k) {
      int i = begin + k, bodies = int(i >= cloth_triangle_count) + int(j >= cloth_triangle_count);
      bool meet = bodies == 1 || (bodies == 0 && cloth_pairs != 0), once = bundles.x != bundles.y || i < j;
      float gap = box_gap_squared(box[k], t.box);
      if (gap <= reach * reach && max(i, j) < triangle_count && meet && once &&
          !share_vertex(numbers[k], t.tags & number_mask)) {
        near |= 1u << (BUNDLE_SIZE * m + k);
        if (gap <= flat_reach * flat_reach) very_near |= 1u << (BUNDLE_SIZE * m + k);
      }
    }
  }
  for (; near != 0u; near &= near - 1u) {
    int number = findLSB(near);
    int i = begin + number % BUNDLE_SIZE, j = other_begin + number / BUNDLE_SIZE;
    bool flat_at_rest = side_by_side_at_rest(rest_place(i), rest_place(j));
    if (!flat_at_rest || (very_near >> number & 1u) != 0u) keep(i, j, flat_at_rest);
  }
}
