// The strain limit, one sweep: each spring's or thread's pull changes by a part of what it lacks, and its ends move
// accordingly. A work group first reads what the sweep before found; if that was good enough, all groups leave
// everything as it is.
#include "strain_limit.glsl"
#ifdef SHEETS
#include "sheet.glsl"
#endif
#include "../methods/group_sums.glsl"
READ_VEC4(group_excess, unit_group_excess);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
// x: the largest excess, as a share of the limit
layout(std430, binding = slot_group_excess) writeonly buffer Excess { vec4 next_group_excess[]; };
layout(std430, binding = slot_limit_control) buffer Control {
  uint groups, groups_y, groups_z;  // of the next sweeps' dispatches: 0 once they have ended
  uint sweeps;
};
uniform int sweep;
uniform float relaxation;  // of springs

uniform int group_count;

#ifdef FEW_GROUPS  // too few to be worth a barrier
float excess_before() {
  float most = 0.0;
  for (int group = 0; group < group_count; ++group) most = max(most, FETCH(group_excess, group).x);
  return most;
}
#else
float excess_before() {
  float most = 0.0;
  for (int group = int(gl_LocalInvocationID.x); group < group_count; group += GROUP_SIZE)
    most = max(most, FETCH(group_excess, group).x);
  return largest_of_group(most);
}
#endif

void main() {
  int i = int(gl_GlobalInvocationID.x);
  bool ended = sweep > 0 && excess_before() <= margin;
  if (ended) {
    if (i == 0) groups = 0;
    return;
  }
  if (i == 0) sweeps = uint(sweep) + 1;
  float most = 0.0;
  if (i < vertex_count) {
    vec4 x = FETCH(position, i);
    vec3 x_start = FETCH(start_position, i).xyz, moved = vec3(0.0);
    vec2 limits = limit[int(FETCH(rest_position, i).w)];
#ifdef SPRINGS
    float largest_strain = limits.x;
    for (EntryRange at = entry_range(Spring_LIST, i); at.first < at.end; at.first += SLICE_SIZE) {
      SpringEntry entry = entry_of_Spring(at.first);
      int j = entry.others[0];
      vec4 y = FETCH(position, j);
      vec3 d = x.xyz - y.xyz;
      float pull = pulls[at.first];
      float rest_length = entry.law.rest_length, allowed = largest_strain * rest_length, mobility = x.w + y.w;
      float excess = length(d) - rest_length - allowed * (1.0 - margin);
      RARELY((excess > 0.0 || pull > 0.0) && allowed > 0.0 && mobility > 0.0) {
        float growth;
        vec3 n = pull_direction(d, x_start - FETCH(start_position, j).xyz, growth);
        float changed = max(pull + relaxation * excess / (mobility * growth), 0.0);
        pulls[at.first] = changed;
        moved -= (changed - pull) * n;
        // Remaining error: the spring is too long, or too short because of the pull.
        most = max(most, (changed > 0.0 ? abs(excess) : excess) / allowed);
      }
    }
#endif
#ifdef SHEETS
    if (limits.x > 0.0) sweep_threads(i, limits, moved, most);
#endif
    next_position[i] = vec4(x.xyz + x.w * moved, x.w);
    RARELY(moved != vec3(0.0)) given[i].xyz += moved;
  }
  most = largest_of_group(most);
  if (gl_LocalInvocationID.x == 0) next_group_excess[gl_WorkGroupID.x] = vec4(most, 0.0, 0.0, 0.0);
}
