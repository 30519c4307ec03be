// Contact, 1 of 4: the listed pairs that may be near at the step's start. A cheap test leaves few of them.
#include "surface.glsl"
#include "reach.glsl"
READ_VEC4(step_start, unit_step_start);
READ_UVEC4(pair_list, unit_surface_pairs);
// From pair_capacity on: the filter has that room for pairs that could meet, later.
layout(std430, binding = slot_chosen_pairs) writeonly buffer Chosen { uint kept_pairs[]; };

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.pairs, pair_capacity)) return;
  uvec4 pair = FETCH(pair_list, item), corner = corners_of(pair);
  vec3 origin = FETCH(step_start, corner.x).xyz;
  Corners c;
  for (int k = 0; k < 4; ++k) c.x[k] = FETCH(step_start, corner[k]).xyz - origin;
  float query = uintBitsToFloat((pair.y & no_force_bit) != 0u ? known.flat_query : known.query);
  if (within_reach(is_edges(pair), c, c, query)) {
    uint place = atomicAdd(control.step_counts[turn].kept, 1u);
    if (place % uint(GROUP_SIZE) == 0u)
      atomicMax(control.step_counts[turn].kept_groups, place / uint(GROUP_SIZE) + 1u);
    kept_pairs[pair_capacity + place] = item;
  }
}
