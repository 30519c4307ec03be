// Neighbour search, 1 of 3: empties the hash.
layout(local_size_x = GROUP_SIZE) in;
#include "cells.glsl"
layout(std430, binding = 3) writeonly buffer CellHeads { uint head[]; };  // [CELL_COUNT] first vertex of the chain

void main() {
  uint stride = gl_NumWorkGroups.x * GROUP_SIZE;
  for (uint cell = gl_GlobalInvocationID.x; cell < CELL_COUNT; cell += stride) head[cell] = chain_end;
}
