// The strain limit, once a step: pulls as the step before ended.
#include "strain_limit.glsl"
layout(std430, binding = 0) writeonly buffer NextPosition { vec4 next_position[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 x_start = FETCH(start_position, i).xyz, moved = vec3(0.0);
  SpringRange range = spring_range(i);
  for (int entry = range.first; entry < range.end; entry += SLICE_SIZE) {
    float pull = pulls[entry];
    RARELY(pull > 0.0) {
      uint j = FETCH(springs, entry).x;
      float growth;
      moved -= pull * pull_direction(x.xyz - FETCH(position, j).xyz, x_start - FETCH(start_position, j).xyz, growth);
    }
  }
  next_position[i] = vec4(x.xyz + x.w * moved, x.w);
  given[i] = vec4(moved, 0.0);
}
