// Symplectic (semi-implicit) Euler: v += a dt, then x += v dt. Hairer, Lubich & Wanner 2006, section I.1.
#include "gather.glsl"
#include "step_end.glsl"

void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next) {
  v_next = v + dt * a + impulse;
  x_next = x.xyz + push + dt * v_next;
}
void end(int i, int met, inout vec3 v_next) {}

#include "whole_step.glsl"
