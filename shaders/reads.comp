// Reads as a step of springs does, to find out which way of reading is faster on a device (server/gl/reads.cpp): each
// item the places of its twelve neighbours on a grid, and its own.
layout(local_size_x = GROUP_SIZE) in;
#include "access.glsl"

READ_VEC4(position, unit_position);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };

void main() {
  const ivec2 springs[] = ivec2[](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1), ivec2(2, 0), ivec2(0, 2));
  int i = int(gl_GlobalInvocationID.x), last = SIDE * SIDE - 1;
  vec4 sum = FETCH(position, i);
  for (int k = 0; k < 6; ++k) {
    int step = springs[k].x + SIDE * springs[k].y;
    sum += FETCH(position, min(i + step, last)) + FETCH(position, max(i - step, 0));
  }
  next_position[i] = sum;
}
