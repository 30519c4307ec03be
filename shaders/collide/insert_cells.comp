// Neighbour search, 1 of 3: adds each vertex to the chain of its cell and notes where the vertex is.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "cells.glsl"
#include "neighbours.glsl"

READ_VEC4(position, 0);
layout(std430, binding = 3) buffer CellHeads { uint head[]; };
layout(std430, binding = 4) writeonly buffer CellChains { uint next[]; };  // [vertex_count] the next vertex in the cell
layout(std430, binding = 5) writeonly buffer PositionWhenBuilt { vec4 position_when_built[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) search_on = 1;
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  next[i] = atomicExchange(head[bucket_of(cell_of(x.xyz))], uint(i));
  position_when_built[i] = x;
}
