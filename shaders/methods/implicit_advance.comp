// Implicit Euler, after each solve: adds the change, or the share of it that the line search found best, to the
// estimates of velocity and position. What the filter kept out of the solution is the impulse of a contact. A contact
// that would have to pull ends; one that would need more than friction gives begins to slide. Both take effect in the
// next Newton step, or else in the next time step. A collider that the estimate has entered becomes a contact for the
// next Newton step.
#include "implicit_euler.glsl"
#include "implicit_friction.glsl"
#define SUMS_AT_ONCE SUMS
#include "group_sums.glsl"
#ifndef CONTACT_TERM
#include "../collide/colliders.glsl"
#endif
READ_VEC4(start_position, unit_start_position);
#ifndef CONTACT_TERM
#include "step_start.glsl"
#endif
READ_VEC4(group_sums, unit_group_sums);
READ_VEC4(change, unit_change);
READ_VEC4(residual, unit_residual);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_estimate) buffer Estimate { vec4 estimate[]; };  // w: number of vertices touched
layout(std430, binding = slot_guess) buffer Guess { vec4 guess[]; };  // of the next change
layout(std430, binding = slot_constraint) buffer Constraint { vec4 constraint[]; };
layout(std430, binding = slot_surface) buffer Surface { vec4 surface[]; };
uniform bool another;  // another Newton step follows in this time step
#ifdef CONTACT_TERM
uniform bool solved;  // false: the change is that of the first estimate, and a part of the guess
#else
const bool solved = true;
#endif
layout(std430, binding = slot_start_velocity) buffer Inertia { vec4 start_velocity[]; };
layout(std430, binding = slot_grip) buffer Grip { vec4 grip[]; };

#include "implicit_total.glsl"
#ifdef CONTACT_TERM
#include "implicit_term.glsl"
#endif
#include "implicit_share.glsl"

/// A linear solver that stops at a tolerance loses momentum, and a free cloth would drift: returns the velocity [m/s]
/// that gives it back to the whole cloth.
vec3 drift(vec4 found[SUMS]) {
#ifdef FREE
  vec4 left_out = found[2];
  return left_out.xyz / left_out.w;
#else
  return vec3(0.0);
#endif
}

#ifndef CONTACT_TERM
/// Updates a contact after the solve. Returns the change of velocity with which the next Newton step begins.
vec3 follow_contact(int i, float inverse_mass, vec3 u) {
  vec4 before = grip[i], under = surface[i];
  vec3 overshot;
  vec4 now = grip_after(before, constraint[i], FETCH(residual, i).xyz, u, under, inverse_mass, overshot);
  start_velocity[i].xyz += braked(before, under.w, inverse_mass) - braked(now, under.w, inverse_mass);
  grip[i] = now;
  float rebound = sticks(constraint[i]) ? -1.0 - constraint[i].w : constraint[i].w;
  bool slides = now.xyz != vec3(0.0) || under.w == 0.0;
  constraint[i].w = slides ? rebound : -1.0 - rebound;
  if (now.w == pulled_away) constraint[i] = vec4(0.0);
  return -overshot;
}

/// Begins the contact with a collider that the estimate has entered. Returns the change of velocity as above.
vec3 meet_contact(int i, float inverse_mass, vec3 start, vec3 x, vec3 u) {
  vec3 stopped = x, after = u, change = vec3(0.0);
  meet_as(i);
  RARELY(resolve_colliders(start, stopped, after, 0.0) > 0) {
    change = met_normal * (dot(stopped - x, met_normal) / dt);
    vec3 sliding = along_surface(u - met_velocity, met_normal);
    vec4 first = first_grip(sliding, length(change) / inverse_mass, met_surface.x, inverse_mass);
    bool slides = first.xyz != vec3(0.0) || met_surface.x == 0.0;
    if (slides) start_velocity[i].xyz -= braked(first, met_surface.x, inverse_mass);
    else change -= sliding;
    constraint[i] = vec4(met_normal, slides ? 0.0 : -1.0);
    surface[i] = vec4(met_velocity, met_surface.x);
    grip[i] = first;
  }
  return change;
}
#endif

void main() {
  vec4 found[SUMS];
  read_totals(found);
#ifdef CONTACT_TERM
  float share = uintBitsToFloat(term.taken);  // implicit_choose.comp
#else
  float share = best_share(found);
#endif
  vec3 regained = drift(found);
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 start = FETCH(start_position, i);
#ifdef CONTACT_TERM
  float own = share * (start.w == 0.0 ? uintBitsToFloat(term.pins) : 1.0);
#else
  float own = start.w == 0.0 ? 1.0 : share;
#endif
  vec3 u = estimate[i].xyz + own * FETCH(change, i).xyz;
  if (solved && share == 1.0) u += regained;  // the sum is valid for the whole change only
  vec3 x = start.xyz + dt * u;
  estimate[i] = vec4(u, start.w > 0.0 ? start_velocity[i].w : 0.0);
  vec3 first = start.w == 0.0 ? (1.0 - own) * FETCH(change, i).xyz : vec3(0.0);
#ifndef CONTACT_TERM
  if (another && start.w > 0.0) {
    bool kept = constraint[i].xyz != vec3(0.0);
    RARELY(kept) first = follow_contact(i, start.w, u);
    if (!kept && grip[i].w != pulled_away) first = meet_contact(i, start.w, step_start(i), x, u);
  }
#endif
  if (!solved) first = guess[i].xyz - own * FETCH(change, i).xyz;
  guess[i] = vec4(first, 0.0);
  next_position[i] = vec4(x, start.w);
}
