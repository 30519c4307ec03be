// Pair search, 3 of 6: pairs of triangles whose boxes are near each other. A triangle looks for others among those of
// its own level and of the larger ones; in its own level half of the cells about it are enough.
#include "surface.glsl"
#include "cells.glsl"
READ_VEC4(boxes, unit_triangle_boxes);
READ_UINT(heads, unit_triangle_cells);
READ_UINT(next, unit_triangle_chains);
layout(std430, binding = slot_triangle_pairs) writeonly buffer TrianglePairs { uvec2 found[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= triangle_count) return;
  vec4 box = FETCH(boxes, 2 * i);
  float reach = reach_of(next_query());
  vec3 half_sides = FETCH(boxes, 2 * i + 1).xyz + reach;
  int own = level_of(box.w), level = own, at = 13;
  float width = cell_width(level);
  ivec3 home = cell_of(box.xyz, width), cell = home;
  uint j = FETCH_UINT(heads, bucket_of(cell, level));
  // One loop walks all chains: the threads of a group, whose chains differ in length, do not wait at each cell.
  for (;;) {
    if (j == chain_end) {
      if (++at == 27) {
        do --level;
        while (level >= 0 && (levels >> level & 1u) == 0u);
        if (level < 0) break;
        width = cell_width(level);
        home = cell_of(box.xyz, width);
        at = 0;
      }
      cell = home + ivec3(at % 3, at / 3 % 3, at / 9) - 1;
      j = FETCH_UINT(heads, bucket_of(cell, level));
      continue;
    }
    vec4 other = FETCH(boxes, 2 * int(j));
    vec3 apart = abs(other.xyz - box.xyz) - FETCH(boxes, 2 * int(j) + 1).xyz;
    // A bucket may hold several cells, and levels. Of two triangles in one cell the first finds the second.
    if (all(lessThanEqual(apart, half_sides)) && level_of(other.w) == level && cell_of(other.xyz, width) == cell &&
        (level < own || at > 13 || uint(i) < j)) {
      uint slot = atomicAdd(triangle_pairs, 1u);
      if (slot < triangle_pair_capacity) {
        found[slot] = uvec2(i, j);
        if (slot % uint(GROUP_SIZE) == 0u) atomicMax(split_groups, slot / uint(GROUP_SIZE) + 1u);
      }
    }
    j = FETCH_UINT(next, j);
  }
}
