// Neighbour search, 1 of 3: empties the hash.
layout(local_size_x = GROUP_SIZE) in;
#include "cells.glsl"

void main() {
  uint stride = gl_NumWorkGroups.x * GROUP_SIZE;
  for (uint cell = gl_GlobalInvocationID.x; cell < CELL_COUNT; cell += stride) head[cell] = -1;
}
