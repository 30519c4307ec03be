// The strain limit, once per step: the corrected positions become the state, and the velocities follow.
#include "strain_limit.glsl"
READ_VEC4(velocity, unit_velocity);
READ_VEC4(corrected_position, unit_corrected_position);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer NextVelocity { vec4 next_velocity[]; };
uniform float dt;  // [s]

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 corrected = FETCH(corrected_position, i).xyz;
  next_position[i] = vec4(corrected, x.w);
  next_velocity[i] = vec4(v.xyz + x.w * given[i].xyz / dt, v.w);
}
