// Pair search, 2 of 10: boxes of leaves, which are LEAF_SIZE triangles each that lie together, and after them of
// bundles: the same, of BUNDLE_SIZE.
#include "surface.glsl"
#include "triangles.glsl"
#include "boxes.glsl"
layout(std430, binding = slot_boxes) writeonly buffer Boxes { vec4 boxes[]; };

void main() {
  int item = int(gl_GlobalInvocationID.x);
  bool leaf = item < leaf_count();
  int size = leaf ? LEAF_SIZE : BUNDLE_SIZE, begin = leaf ? LEAF_SIZE * item : BUNDLE_SIZE * (item - leaf_count());
  if (begin >= triangle_count) return;
  vec3 low = vec3(1e30), high = vec3(-1e30);
  for (int i = begin; i < min(begin + size, triangle_count); ++i) {
    Triangle t = triangle_at(i);
    low = min(low, low_of(t));
    high = max(high, high_of(t));
  }
  boxes[2 * item] = vec4(low, 0.0);
  boxes[2 * item + 1] = vec4(high, 0.0);
}
