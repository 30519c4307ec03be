// Validity of the listed pairs, 1 of 2: for each block of triangles the box about its vertices at the last search, and
// the box about their motions since.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(position_when_built, unit_position_when_built);
READ_UINT(block_vertices, unit_block_vertices);  // where each block's list ends, then the lists
layout(std430, binding = slot_block_boxes) writeonly buffer Boxes { vec4 boxes[]; };  // places, then motions
uniform int block_count;

void main() {
  int block = int(gl_GlobalInvocationID.x);
  if (block >= block_count) return;
  uint begin = block > 0 ? FETCH_UINT(block_vertices, block - 1) : uint(block_count);
  uint end = FETCH_UINT(block_vertices, block);
  vec3 low = vec3(1e30), high = vec3(-1e30), motion_low = low, motion_high = high;
  for (uint k = begin; k < end; ++k) {
    uint vertex = FETCH_UINT(block_vertices, k);
    vec3 built = FETCH(position_when_built, vertex).xyz, moved = FETCH(position, vertex).xyz - built;
    low = min(low, built);
    high = max(high, built);
    motion_low = min(motion_low, moved);
    motion_high = max(motion_high, moved);
  }
  boxes[4 * block] = vec4(low, 0.0);
  boxes[4 * block + 1] = vec4(high, 0.0);
  boxes[4 * block + 2] = vec4(motion_low, 0.0);
  boxes[4 * block + 3] = vec4(motion_high, 0.0);
}
