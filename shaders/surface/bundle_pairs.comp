// Pair search, 4 of 10: pairs of bundles, of two near leaves, whose boxes are near each other; a bundle is near itself.
#include "surface.glsl"
#include "box_list.glsl"
READ_UVEC2(leaf_pair_list, unit_leaf_pairs);
layout(std430, binding = slot_bundle_pairs) writeonly buffer BundlePairs { uvec2 found[]; };

const int bundles_of_leaf = LEAF_SIZE / BUNDLE_SIZE;

void main() {
  int item = int(gl_GlobalInvocationID.x);
  if (item / bundles_of_leaf >= int(min(known.leaf_pairs, leaf_pair_capacity))) return;
  ivec2 leaves = ivec2(FETCH_UVEC2(leaf_pair_list, item / bundles_of_leaf));
  int bundle_count = (triangle_count + BUNDLE_SIZE - 1) / BUNDLE_SIZE;
  int one = bundles_of_leaf * leaves.x + item % bundles_of_leaf, first = bundles_of_leaf * leaves.y;
  if (one >= bundle_count) return;
  float reach = reach_of(next_query());
  Box box = box_at(leaf_count() + one);
  uint near = 0u;
  for (int k = 0; k < bundles_of_leaf; ++k) {
    int other = min(first + k, bundle_count - 1);
    if (box_gap_squared(box, box_at(leaf_count() + other)) <= reach * reach &&
        first + k < bundle_count && (leaves.x != leaves.y || one <= other))
      near |= 1u << k;
  }
  if (near != 0u) {
    uint slot = atomicAdd(control.bundle_pairs, uint(bitCount(near)));
    uint end = min(slot + uint(bitCount(near)), bundle_pair_capacity);
    if (slot < end) atomicMax(control.bundle_groups, (end - 1u) / uint(GROUP_SIZE) + 1u);
    for (; slot < end; near &= near - 1u, ++slot) found[slot] = uvec2(one, first + findLSB(near));
  }
}
