// Implicit Euler, once a step: what self-collision adds, which vertices a pin or a collider constrains, and the first guess.
#include "implicit_euler.glsl"
#include "../collide/colliders.glsl"
#ifdef SELF_COLLISION
#include "../collide/neighbours.glsl"
#include "../collide/self_contact.glsl"
#endif
layout(std430, binding = 0) writeonly buffer Start { vec4 start_position[]; };      // w: inverse mass
layout(std430, binding = 1) writeonly buffer Inertia { vec4 start_velocity[]; };    // w: vertices touched
layout(std430, binding = 3) writeonly buffer Estimate { vec4 estimate[]; };         // of the velocity: 0
layout(std430, binding = 4) writeonly buffer Guess { vec4 first_guess[]; };         // the solver's
layout(std430, binding = 5) buffer Constraint { vec4 constraint[]; };   // normal of the contact, or 0; speed of the rebound
layout(std430, binding = 6) writeonly buffer Surface { vec4 surface[]; };  // its velocity, its friction

/// Left alone by the springs, would the vertex meet a collider, or stay near one? Then its velocity along the normal is
/// the one that takes it to the surface, whatever the springs say; unless the last step found that they pull it away.
/// Near is a quarter of its way: one that slides over a sphere must not count as leaving. Returns the guess of the velocity.
vec3 foresee(int i, vec3 x, vec3 v) {
  vec3 guess = v + dt * gravity.xyz;
  vec3 stopped = x + dt * guess, after = guess;
  bool pulled_away = constraint[i].w < 0.0;
  constraint[i] = vec4(0.0);
  float near = 0.25 * dt * length(guess);
  RARELY(!pulled_away && resolve_colliders(x, stopped, after, near) > 0) {
    guess += met_normal * ((dot(stopped - x, met_normal) - near) / dt - dot(guess, met_normal));
    // What gravity gives in two steps is no impact: a vertex at rest must not bounce.
    float approach = dot(met_velocity - v, met_normal);
    float rebound = approach > 2.0 * dt * length(gravity.xyz) ? met_surface.y * approach : 0.0;
    constraint[i] = vec4(met_normal, rebound);
    surface[i] = vec4(met_velocity, met_surface.x);
  }
  return guess;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 push = vec3(0.0), impulse = vec3(0.0), guess;
  int contacts = 0;
  if (x.w == 0.0) {
    vec3 x_next, v_next;
    follow_motion(i, v.w, END_ROW, x_next, v_next);
    guess = (x_next - x.xyz) / dt;
  } else {
#ifdef SELF_COLLISION
    contacts = self_contacts(i, x, v, push, impulse);
#endif
    guess = foresee(i, x.xyz + push, v.xyz + impulse);
  }
  start_position[i] = vec4(x.xyz + push, x.w);
  start_velocity[i] = vec4(v.xyz + impulse, float(contacts));
  estimate[i] = vec4(0.0);
  first_guess[i] = vec4(guess, 0.0);
}
