// Implicit Euler, once per step: the wind, from the state at the step's start and the air at its end. Its force on a
// vertex is taken as f - braking (u - v), linear in the velocity u at the step's end: so it acts like a gain of
// velocity and a drag of the vertex's own (semi-implicit), and in no step takes more than the flow's speed.
#include "implicit_euler.glsl"
// xyz: gain of velocity [m/s]; w: drag [1/s]
layout(std430, binding = slot_wind) writeonly buffer WindLoads { vec4 loads[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 v = FETCH(velocity, i).xyz;
  WindLoad load = wind_on(i, x.xyz, v, wind_velocity(END_ROW));
  loads[i] = vec4(dt * x.w * (load.force + load.braking * v), x.w * load.braking);
}
