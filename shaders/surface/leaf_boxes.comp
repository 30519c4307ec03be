// Pair search, 2 of 9: boxes of leaves, which are LEAF_SIZE triangles each that lie together.
#include "surface.glsl"
#include "triangles.glsl"
layout(std430, binding = slot_leaf_boxes) writeonly buffer LeafBoxes { vec4 leaf_boxes[]; };

void main() {
  int leaf = int(gl_GlobalInvocationID.x);
  if (LEAF_SIZE * leaf >= triangle_count) return;
  vec3 low = vec3(1e30), high = vec3(-1e30);
  for (int i = LEAF_SIZE * leaf; i < min(LEAF_SIZE * (leaf + 1), triangle_count); ++i) {
    Triangle t = triangle_at(i);
    low = min(low, low_of(t));
    high = max(high, high_of(t));
  }
  leaf_boxes[2 * leaf] = vec4(low, 0.0);
  leaf_boxes[2 * leaf + 1] = vec4(high, 0.0);
}
