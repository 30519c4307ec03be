// Neighbour search, 1 of 3: adds each vertex to the chain of its cell and notes where the vertex is.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "cells.glsl"
#include "neighbours.glsl"

READ_VEC4(position, unit_position);
layout(std430, binding = slot_cell_heads) buffer CellHeads { uint head[]; };
// [vertex_count] the vertex' place, as bits, and the next vertex in the cell: the search reads both at once
layout(std430, binding = slot_cell_chains) writeonly buffer CellChains { uvec4 links[]; };
layout(std430, binding = slot_position_when_built) writeonly buffer PositionWhenBuilt { vec4 position_when_built[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) search_on = 1;
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  links[i] = uvec4(floatBitsToUint(x.xyz), atomicExchange(head[bucket_of(cell_of(x.xyz))], uint(i)));
  position_when_built[i] = x;
}
