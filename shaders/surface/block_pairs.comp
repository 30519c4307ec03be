// Validity of the listed pairs, 2 of 2: asks for a search if two blocks have moved so far, relative to each other, that
// a pair which the last search left out may be near now. Motion that both share, such as a falling or a swinging
// cloth's, does not count. A pair that was left out was farther apart than the search reached, and no nearer than the
// boxes of its blocks; how much nearer it came is at most the largest relative motion of its corners.
#include "surface.glsl"
READ_VEC4(boxes, unit_block_boxes);
uniform int block_count;

const float rounding = 1.001;

void main() {
  int one = int(gl_GlobalInvocationID.x);
  if (one >= block_count) return;
  vec3 low = FETCH(boxes, 4 * one).xyz, high = FETCH(boxes, 4 * one + 1).xyz;
  vec3 motion_low = FETCH(boxes, 4 * one + 2).xyz, motion_high = FETCH(boxes, 4 * one + 3).xyz;
  bool valid = true;
  // Each two blocks once: every block looks at the half of the ring that begins with itself.
  for (int k = 0; k <= block_count / 2; ++k) {
    int other = one + k < block_count ? one + k : one + k - block_count;
    vec3 relative = max(abs(motion_high - FETCH(boxes, 4 * other + 2).xyz),
                        abs(motion_low - FETCH(boxes, 4 * other + 3).xyz));
    vec3 between = max(max(low - FETCH(boxes, 4 * other + 1).xyz, FETCH(boxes, 4 * other).xyz - high), vec3(0.0));
    float room = max(length(between) - uintBitsToFloat(query), skin);
    valid = valid && rounding * length(relative) <= room;
  }
  if (!valid) rebuild_groups = uint((max(vertex_count, triangle_count) + GROUP_SIZE - 1) / GROUP_SIZE);
}
