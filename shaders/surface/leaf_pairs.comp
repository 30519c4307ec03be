// Pair search, 3 of 10: pairs of leaves whose boxes are near each other; a leaf is near itself.
#include "surface.glsl"
#include "box_list.glsl"
layout(std430, binding = slot_leaf_pairs) writeonly buffer LeafPairs { uvec2 found[]; };

uniform int cloth_pairs;  // 0: cloths meet bodies alone

void main() {
  int one = int(gl_GlobalInvocationID.x);
  int cloth_leaves = (cloth_triangle_count + LEAF_SIZE - 1) / LEAF_SIZE;
  if (one >= cloth_leaves) return;
  float reach = reach_of(next_query());
  Box box = box_at(one);
  // Each two leaves of cloths once: every leaf looks at the half of the ring that begins with itself; and at all leaves
  // of bodies. A leaf may hold both, at the border.
  int of_cloths = cloth_leaves / 2 + 1;
  int count = of_cloths + leaf_count() - cloth_leaves, first_bough = leaf_count() + bundle_count();
  for (int k = 0; k < count; ++k) {
    bool body = k >= of_cloths;
    int other = body ? cloth_leaves + k - of_cloths : one + k < cloth_leaves ? one + k : one + k - cloth_leaves;
    // A whole bough that is far away is passed over.
    if (has_boughs() && other % BOUGH_SIZE == 0 && other + BOUGH_SIZE <= (body ? leaf_count() : cloth_leaves) &&
        k + BOUGH_SIZE <= (body ? count : of_cloths) &&
        box_gap_squared(box, box_at(first_bough + other / BOUGH_SIZE)) > reach * reach) {
      k += BOUGH_SIZE - 1;
      continue;
    }
    if (box_gap_squared(box, box_at(other)) <= reach * reach &&
           (body || 2 * k != cloth_leaves || one < other) &&
           (cloth_pairs != 0 || LEAF_SIZE * (max(one, other) + 1) > cloth_triangle_count)) {
      uint slot = atomicAdd(control.leaf_pairs, 1u);
      if (slot < leaf_pair_capacity) {
        found[slot] = uvec2(one, other);
        atomicMax(control.leaf_groups, slot * uint(LEAF_SIZE / BUNDLE_SIZE) / uint(GROUP_SIZE) + 1u);
      }
    }
  }
}
