// Pair search, 3 of 6: pairs of triangles whose boxes are near each other. A triangle looks for others among those of
// its own level and of the larger ones; in its own level half of the cells about it are enough. Those that lie side by
// side at rest would all be near each other in a fine mesh: the search does not reach as far for them.
#include "surface.glsl"
#include "cells.glsl"
READ_VEC4(boxes, unit_triangle_boxes);
READ_UINT(heads, unit_triangle_cells);
READ_UINT(next, unit_triangle_chains);
READ_VEC4(rest_boxes, unit_rest_boxes);  // middle, cloth; half of each side; normal
layout(std430, binding = slot_triangle_pairs) writeonly buffer TrianglePairs { uvec2 found[]; };

/// Near triangles of a cloth are side by side if their middles are this far out of each other's plane, or less, as a
/// share of their distance.
const float out_of_plane = 0.35;

bool side_by_side_at_rest(int i, int j) {
  vec4 middle = FETCH(rest_boxes, 3 * i), other = FETCH(rest_boxes, 3 * j);
  vec3 between = other.xyz - middle.xyz;
  vec3 apart = abs(between) - FETCH(rest_boxes, 3 * i + 1).xyz - FETCH(rest_boxes, 3 * j + 1).xyz;
  float flat_enough = out_of_plane * length(between);
  return middle.w == other.w && all(lessThan(apart, vec3(reach_of(1.2 * thickness)))) &&
         abs(dot(FETCH(rest_boxes, 3 * i + 2).xyz, between)) <= flat_enough &&
         abs(dot(FETCH(rest_boxes, 3 * j + 2).xyz, between)) <= flat_enough;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= triangle_count) return;
  vec4 box = FETCH(boxes, 2 * i);
  float reach = reach_of(next_query()), flat_reach = reach_of(next_flat_query());
  vec3 half_sides = FETCH(boxes, 2 * i + 1).xyz;
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
    vec3 apart = abs(other.xyz - box.xyz) - FETCH(boxes, 2 * int(j) + 1).xyz - half_sides;
    float farthest = max(apart.x, max(apart.y, apart.z));
    // A bucket may hold several cells, and levels. Of two triangles in one cell the first finds the second.
    if (farthest <= reach && level_of(other.w) == level && cell_of(other.xyz, width) == cell &&
        (level < own || at > 13 || uint(i) < j)) {
      bool flat_at_rest = side_by_side_at_rest(i, int(j));
      if (!flat_at_rest || farthest <= flat_reach) {
        uint slot = atomicAdd(triangle_pairs, 1u);
        if (slot < triangle_pair_capacity) {
          found[slot] = uvec2(i, flat_at_rest ? j | flat_bit : j);
          if (slot % uint(GROUP_SIZE) == 0u) atomicMax(split_groups, slot / uint(GROUP_SIZE) + 1u);
        }
      }
    }
    j = FETCH_UINT(next, j);
  }
}
