// Explicit (forward) Euler: x += v dt, v += a dt, both from the state at the step's start. Undamped, it gains energy at
// any dt: it is here to show that it fails. Hairer, Lubich & Wanner 2006, section I.1.
#include "gather.glsl"
#include "step_end.glsl"

void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next) {
  x_next = x.xyz + push + dt * (v + impulse);  // an impulse acts at the step's start
  v_next = v + dt * a + impulse;
}
void end(int i, int met, inout vec3 v_next) {}

#include "whole_step.glsl"
