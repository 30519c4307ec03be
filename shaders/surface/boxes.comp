// Pair search, 2 of 10: boxes of leaves, which are LEAF_SIZE triangles each that lie together; after them of bundles,
// which are BUNDLE_SIZE triangles; and of boughs.
#include "surface.glsl"
#include "triangles.glsl"
layout(std430, binding = slot_boxes) writeonly buffer Boxes { vec4 boxes[]; };

void main() {
  int item = int(gl_GlobalInvocationID.x);
  int bundle = item - leaf_count(), bough = bundle - bundle_count();
  if (bough >= bough_count()) return;
  int size = bundle < 0 ? LEAF_SIZE : bough < 0 ? BUNDLE_SIZE : LEAF_SIZE * BOUGH_SIZE;
  int begin = size * (bundle < 0 ? item : bough < 0 ? bundle : bough);
  Box box = Box(vec3(1e30), vec3(-1e30), vec3(1e30), vec3(-1e30));
  for (int i = begin; i < min(begin + size, triangle_count); ++i) {
    Box its = triangle_at(i).box;
    box = Box(min(box.low, its.low), max(box.high, its.high), min(box.low_ahead, its.low_ahead),
              max(box.high_ahead, its.high_ahead));
  }
  boxes[4 * item] = vec4(box.low, 0.0);
  boxes[4 * item + 1] = vec4(box.high, 0.0);
  boxes[4 * item + 2] = vec4(box.low_ahead, 0.0);
  boxes[4 * item + 3] = vec4(box.high_ahead, 0.0);
}
