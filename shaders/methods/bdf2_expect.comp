// BDF2, before the wind: the state that the last step's way and gain lead to, in which the wind is taken. Taken at the
// step's start it would leave an error of first order.
#include "implicit_euler.glsl"
#include "bdf2.glsl"
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 expected_position[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer NextVelocity { vec4 expected_velocity[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  expected_position[i] = vec4(x.xyz + 3.0 * (origin_of(i, x.xyz) - x.xyz), x.w);
  expected_velocity[i] = vec4(v.xyz + 3.0 * (carried_on(i, v.xyz) - v.xyz), v.w);
}
