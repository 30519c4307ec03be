// Pair search, 3 of 7: pairs of leaves whose boxes are near each other; a leaf is near itself.
#include "surface.glsl"
READ_VEC4(leaf_boxes, unit_leaf_boxes);
layout(std430, binding = slot_leaf_pairs) writeonly buffer LeafPairs { uvec2 found[]; };

void main() {
  int one = int(gl_GlobalInvocationID.x), leaf_count = (triangle_count + LEAF_SIZE - 1) / LEAF_SIZE;
  if (one >= leaf_count) return;
  float reach = reach_of(next_query());
  vec3 low = FETCH(leaf_boxes, 2 * one).xyz - reach, high = FETCH(leaf_boxes, 2 * one + 1).xyz + reach;
  // Each two leaves once: every leaf looks at the half of the ring that begins with itself.
  for (int k = 0; k <= leaf_count / 2; ++k) {
    int other = one + k < leaf_count ? one + k : one + k - leaf_count;
    RARELY(all(lessThanEqual(low, FETCH(leaf_boxes, 2 * other + 1).xyz)) &&
           all(lessThanEqual(FETCH(leaf_boxes, 2 * other).xyz, high)) && (2 * k != leaf_count || one < other)) {
      uint slot = atomicAdd(control.leaf_pairs, 1u);
      if (slot < leaf_pair_capacity) {
        found[slot] = uvec2(one, other);
        atomicMax(control.leaf_groups, slot * uint(LEAF_SIZE / TOGETHER) / uint(GROUP_SIZE) + 1u);
      }
    }
  }
}
