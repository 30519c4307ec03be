// The strain limit, once a step: pulls as the step before ended.
#include "strain_limit.glsl"
layout(std430, binding = 0) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = 3) readonly buffer Pulls { float pulls[]; };  // of each entry of the spring lists [kg m]

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 moved = vec3(0.0);
  SpringRange range = spring_range(i);
  for (int entry = range.first; entry < range.end; entry += GROUP_SIZE) {
    float pull = pulls[entry], distance, growth;
    if (!(pull > 0.0)) continue;
    uint other = FETCH(springs, entry).x;
    moved -= pull * pull_direction(i, other, x.xyz, FETCH(position, other).xyz, distance, growth);
  }
  next_position[i] = vec4(x.xyz + x.w * moved, x.w);
}
