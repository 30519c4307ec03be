// Velocity Verlet with one evaluation of the forces per step: Swope et al. 1982; Hairer, Lubich & Wanner 2006, section
// I.1. Forces that depend on the velocity need it at the step's end before it is known: a first-order prediction there,
// w = v + a dt, keeps the method at order 2, damping included. So the state holds x and w; `carried` holds what a
// vertex needs to find the velocity in the middle of the last step. A contact is an impulse within the step: it changes
// the velocity in the step's middle, with which the vertex has moved, and the prediction likewise. If the step after a
// contact began anew from the velocity at its start, a sliding or resting vertex would be stepped by explicit Euler.
#define MOST_OF_FLOW most_of_flow_predicted
#include "gather.glsl"
#include "step_end.glsl"
#define SECOND_VELOCITY

/// xyz: w less the velocity in the middle of the last step [m/s]; w: dt of that step [s]. Both are 0 after a start:
/// then the state's w is the present velocity. As it is a difference, a change of the state's w changes both
/// velocities.
READ_VEC4(carried, unit_carried);
layout(std430, binding = slot_carried) writeonly buffer Carried { vec4 next_carried[]; };
vec4 carry;

#include "whole_step.glsl"

/// v_next: the velocity in the middle of the step; second_velocity: the velocity at its end.
void integrate(int i, vec4 x, vec3 v, vec3 a, vec3 push, vec3 impulse, out vec3 x_next, out vec3 v_next) {
  vec4 before = FETCH(carried, i);
  vec3 now = v - before.xyz + (0.5 * before.w) * a + impulse;
  v_next = now + (0.5 * dt) * a;
  x_next = x.xyz + push + dt * v_next;
  second_velocity = now + dt * a;
  carry = vec4((0.5 * dt) * a, dt);
}
void end(int i, int met, inout vec3 v_next) {
  RARELY(met > 0) carry.xyz = second_velocity - v_next;
  next_carried[i] = carry;
  v_next = second_velocity;
}
