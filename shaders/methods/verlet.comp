// Velocity Verlet with one evaluation of the forces a step: Swope et al. 1982; Hairer, Lubich & Wanner 2006, section I.1.
// Forces that depend on the velocity need it at the step's end before that is known: a first-order prediction there,
// w = v + a dt, keeps the method second order, damping included. So the state holds x and w; what a vertex alone needs,
// the velocity in the middle of the last step, is carried beside it.
#include "gather.glsl"
#include "step_end.glsl"

/// xyz: velocity half a step ago [m/s]; w: the dt of that step [s], 0 after a start or a contact: then it is the velocity now.
layout(std430, binding = 3) buffer Carried { vec4 middle_velocity[]; };

void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next) {
  vec4 before = middle_velocity[i];
  vec3 now = before.xyz + (0.5 * before.w) * a + impulse;
  vec3 middle = now + (0.5 * dt) * a;
  x_next = x.xyz + push + dt * middle;
  v_next = now + dt * a;
  middle_velocity[i] = vec4(middle, dt);
}
void touched(int i, vec3 v_next) { middle_velocity[i] = vec4(v_next, 0.0); }

#include "whole_step.glsl"
