// Pair search, 2 of 6: adds each triangle to the chain of its cell.
#include "surface.glsl"
#include "cells.glsl"
READ_VEC4(boxes, unit_triangle_boxes);
layout(std430, binding = slot_triangle_cells) buffer Cells { uint heads[]; };
layout(std430, binding = slot_triangle_chains) writeonly buffer Chains { uint next[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= triangle_count) return;
  vec4 box = FETCH(boxes, 2 * i);
  int level = level_of(box.w);
  atomicOr(levels, 1u << level);
  next[i] = atomicExchange(heads[bucket_of(cell_of(box.xyz, cell_width(level)), level)], uint(i));
}
