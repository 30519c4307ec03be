// Implicit Euler, once per step: what self-collision adds, which vertices a pin or a collider constrains, and the first
// guess.
#include "implicit_euler.glsl"
#include "implicit_friction.glsl"
#include "bdf2.glsl"
#ifndef CONTACT_TERM
#include "../collide/colliders.glsl"
#endif
#ifdef SELF_COLLISION
#include "../collide/neighbours.glsl"
#define CONTACT_TIME whole_dt
#include "../collide/self_contact.glsl"
#endif
layout(std430, binding = slot_start_position) writeonly buffer Start { vec4 start_position[]; };  // w: inverse mass
// w: number of vertices touched
layout(std430, binding = slot_start_velocity) writeonly buffer Inertia { vec4 start_velocity[]; };
layout(std430, binding = slot_estimate) writeonly buffer Estimate { vec4 estimate[]; };  // velocity
layout(std430, binding = slot_guess) writeonly buffer Guess { vec4 first_guess[]; };  // of the solver
#ifdef CONTACT_TERM
// The change of the first estimate that the start's velocity makes.
layout(std430, binding = slot_first_change) writeonly buffer FirstChange { vec4 first_change[]; };
#endif
layout(std430, binding = slot_constraint) writeonly buffer Constraint { vec4 constraint[]; };
// its velocity [m/s], its friction
layout(std430, binding = slot_surface) writeonly buffer Surface { vec4 surface[]; };
// read: of the last step; written: of this step
#ifdef BDF2
uniform float grip_scale;  // dt over that of the last step: an impulse is a force times dt
#endif
layout(std430, binding = slot_grip) buffer Grip { vec4 grip[]; };

/// Velocity at which a vertex enters the solve, the first estimate, and the guess of the velocity that comes out [m/s].
struct Beginning {
  vec3 velocity, estimate, guess;
};

/// The first estimate of the velocity [m/s]: `expected`. But where contact is a term of the problem it is the one that
/// leaves the vertex at x, where the step begins, as contact may allow no more than a share of the way from there: what
/// lacks is a change of its own, before the first solve.
vec3 first_estimate(int i, vec3 expected, vec3 x, vec3 origin) {
#ifdef CONTACT_TERM
  vec3 here = (x - origin) / dt;
  first_change[i] = vec4(expected - here, 0.0);
  return here;
#else
  return expected;
#endif
}

#ifndef CONTACT_TERM
/// Applies friction to a vertex that is kept at the surface just met.
void rub(int i, float inverse_mass, float impulse, inout Beginning start) {
  vec4 kept = grip[i];
#ifdef BDF2
  if (kept.w > 0.0) kept.w *= grip_scale;
#endif
  vec3 sliding = along_surface(start.guess - met_velocity, met_normal);
  if (kept.w < 0.0) kept = first_grip(sliding, impulse, met_surface.x, inverse_mass);
  else kept.xyz = direction(along_surface(kept.xyz, met_normal));
  bool slides = kept.xyz != vec3(0.0) || met_surface.x == 0.0;
  vec3 taken = slides ? braked(kept, met_surface.x, inverse_mass) : sliding;
  if (slides) start.velocity -= taken;
  start.guess -= taken;
  // A speed that gravity gives in two steps is no impact: a vertex at rest must not bounce.
  float approach = dot(met_velocity - start.velocity, met_normal);
  float rebound = approach > 2.0 * whole_dt * length(gravity.xyz) ? met_surface.y * approach : 0.0;
  constraint[i] = vec4(met_normal, slides ? rebound : -1.0 - rebound);
  surface[i] = vec4(met_velocity, met_surface.x);
  grip[i] = kept;
}
#endif

/// Finds out if a vertex without springs would meet a collider or stay near one. Then its velocity along the normal is
/// the one that takes it to the surface, whatever the springs do, unless they pulled it away in the last step. Near is
/// a quarter of its way: a vertex that slides over a sphere must not count as leaving. `from`: where it is; x: where
/// the step's equations have it; `estimate`: the first one [m/s], unless it meets a collider.
Beginning foresee(int i, vec3 from, vec3 x, vec3 v, vec3 estimate, float inverse_mass) {
  Beginning start = Beginning(v, estimate, v + dt * gravity.xyz);
#ifdef WIND
  vec4 load = FETCH(wind_loads, i);
  start.guess = (start.guess + load.xyz) / (1.0 + dt * load.w);
#endif
  constraint[i] = vec4(0.0);
#ifdef CONTACT_TERM  // solids press, as the surfaces do
  grip[i] = vec4(vec3(0.0), untouched);
#else
  vec3 stopped = x + dt * start.guess, after = start.guess;
  bool pulled = grip[i].w == pulled_away;
  float near = 0.25 * dt * length(start.guess);
  bool met = false;
  meet_as(i);
  RARELY(!pulled && resolve_colliders(from, stopped, after, near) > 0) {
    met = true;
    float lacks = (dot(stopped - x, met_normal) - near) / dt - dot(start.guess, met_normal);
    start.guess += met_normal * lacks;
    rub(i, inverse_mass, max(lacks, 0.0) / inverse_mass, start);
    start.estimate = start.guess;
  }
  if (!met) grip[i] = vec4(vec3(0.0), untouched);
#endif
  return start;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 push = vec3(0.0), impulse = vec3(0.0), origin = origin_of(i, x.xyz);
  Beginning start;
  int contacts = 0;
  if (x.w == 0.0) {
    vec3 x_next, v_next;
    follow_motion(i, x.xyz, v.w, END_ROW, x_next, v_next);
    vec3 whole = (x_next - origin) / dt;
    start = Beginning(v.xyz, first_estimate(i, whole, x.xyz, origin), whole);
  } else {
#ifdef SELF_COLLISION
    contacts = self_contacts(i, x, v, push, impulse);
#endif
    origin += push;
    vec3 estimate = first_estimate(i, v.xyz + impulse, x.xyz, origin);
    start = foresee(i, x.xyz + push, origin, carried_on(i, v.xyz + impulse), estimate, x.w);
#ifdef WIND
    start.velocity += FETCH(wind_loads, i).xyz;
#endif
  }
  start_position[i] = vec4(origin, x.w);
  start_velocity[i] = vec4(start.velocity, float(contacts));
  estimate[i] = vec4(start.estimate, 0.0);
  first_guess[i] = vec4(start.guess - start.estimate, 0.0);
}
