// The strain limit, once per step: begins with the pulls at which the step before ended.
#include "strain_limit.glsl"
#ifdef SHEETS
#include "sheet.glsl"
#endif
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 x_start = FETCH(start_position, i).xyz, moved = vec3(0.0);
#ifdef SPRINGS
  for (EntryRange at = entry_range(Spring_LIST, i); at.first < at.end; at.first += SLICE_SIZE) {
    float pull = pulls[at.first];
    RARELY(pull > 0.0) {
      int j = entry_of_Spring(at.first).others[0];
      float growth;
      moved -= pull * pull_direction(x.xyz - FETCH(position, j).xyz, x_start - FETCH(start_position, j).xyz, growth);
    }
  }
#endif
#ifdef SHEETS
  moved += pulled_by_threads(i);
#endif
  next_position[i] = vec4(x.xyz + x.w * moved, x.w);
  given[i] = vec4(moved, 0.0);
}
