// Implicit Euler, once per step: the new state, after rebounds and after colliders that implicit_start did not foresee;
// and the state in which each contact begins the next step.
#include "implicit_euler.glsl"
#include "implicit_friction.glsl"
#include "step_end.glsl"
#ifdef CONTACT_TERM
#define SOLIDS_IN_PIECES
#endif
#include "../collide/colliders.glsl"
#ifdef CONTACT_TERM
#include "../surface/term_solids.glsl"
#include "touching.glsl"
READ_VEC4(body_places, unit_body_places);  // home, motion; friction, restitution, a box's corner
#endif
READ_VEC4(before_position, unit_before_position);  // the state at the step's start
READ_VEC4(before_velocity, unit_before_velocity);
READ_VEC4(start_velocity, unit_start_velocity);  // w: number of vertices touched
READ_VEC4(residual, unit_residual);
READ_VEC4(surface, unit_surface);
READ_VEC4(constraint, unit_constraint);
layout(std430, binding = slot_grip) buffer Grip { vec4 grip[]; };

#ifdef CONTACT_TERM
#if SOLID_ROWS > 0
/// Lets a vertex rebound from a solid that presses it at the step's end. Returns 1 for one that does, else 0.
int rebound(int kind, bool moves, int first, vec3 before, vec3 x, inout vec3 v) {
  Solid start, end;
  place_solid(kind, moves, first, 0.0, start, end);
  vec3 n;
  bool presses = nearest_of_solid(kind, end, x, n) > 0.0;
  vec3 moving = solid_velocity(first, x);
  float approach = dot(moving - before, n), restitution = solids[first + 2].y;
  // A speed that gravity gives in two steps is no impact: a vertex at rest must not bounce.
  if (presses && restitution > 0.0 && approach > 2.0 * whole_dt * length(gravity.xyz))
    v += n * (restitution * approach - dot(v - moving, n));
  return int(presses);
}
#endif

/// Ends the step of a vertex at solids: what the step's problem left within one comes out of it here, without speed.
/// Returns how many it touches.
int leave_solids(int i, vec3 start, inout vec3 x, inout vec3 v) {
  int met = 0;
  meet_as(i);
#if SOLID_ROWS > 0
  float deep = -0.999 * margin;
  RARELY(depth_in_solids_at_rest(x, deep) > 0.0 || depth_in_moving_solids(x, deep) > 0.0) {
    resolve_colliders(start, x, v, 0.0);
    x -= met_braking;
  }
  vec3 before = FETCH(before_velocity, i).xyz;
#define REBOUND(kind, moves, first, end) \
  for (int row = first; row < end; row += solid_rows(kind)) met += rebound(kind, moves, row, before, x, v);
  EACH_SOLID(REBOUND)
#endif
  return met;
}

/// Lets a vertex rebound from bodies that press it at the step's end.
void rebound_from_bodies(int i, inout vec3 v) {
  uvec2 listed = FETCH_UVEC2(term_vertices, i);
  for (uint place = listed.x; place < listed.x + listed.y; ++place) {
    Touch t = touch_at(place);
    int body = int(max(t.corner.x, t.corner.w)) - vertex_count;
    vec3 relative = vec3(0.0), of_body = vec3(0.0);  // velocities of the nearest points, and of the body's
    for (int c = 0; c < 4; ++c) {
      vec3 its = t.weight[c] * FETCH(before_velocity, t.corner[c]).xyz;
      relative += its;
      if (int(t.corner[c]) >= vertex_count) of_body += abs(t.weight[c]) * FETCH(before_velocity, t.corner[c]).xyz;
    }
    vec3 away = t.own > 0.0 ? t.n : -t.n;
    float approach = -dot(t.n, relative), restitution = body < 0 ? 0.0 : FETCH(body_places, 2 * body + 1).y;
    if (restitution > 0.0 && approach > 2.0 * whole_dt * length(gravity.xyz))
      v += away * max(restitution * approach - dot(v - of_body, away), 0.0);
  }
}
#else
/// Ends the step of a vertex that was kept on a surface.
void leave_contact(int i, float inverse_mass, inout vec3 x, inout vec3 v) {
  vec4 held = FETCH(constraint, i), under = FETCH(surface, i);
  vec3 overshot;
  vec4 now = grip_after(grip[i], held, FETCH(residual, i).xyz, v, under, inverse_mass, overshot);
  // The impulse that stopped the vertex on its way in is not needed in the next step.
  float impact = max(-dot(FETCH(before_velocity, i).xyz - under.xyz, held.xyz), 0.0) / inverse_mass;
  if (now.w >= 0.0) now.w = max(now.w - impact, 0.0);
  grip[i] = now;
  x -= dt * overshot;
  v += held.xyz * ((sticks(held) ? -1.0 - held.w : held.w) - leaving(v, under, held.xyz)) - overshot;
}
#endif

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 x_next, v_next;
  float tag = FETCH(before_velocity, i).w;
  if (x.w == 0.0) {
    follow_motion(i, FETCH(before_position, i).xyz, tag, END_ROW, x_next, v_next);
  } else {
    x_next = x.xyz;
    v_next = FETCH(velocity, i).xyz;
#ifdef CONTACT_TERM
    int met = leave_solids(i, FETCH(before_position, i).xyz, x_next, v_next);
    rebound_from_bodies(i, v_next);
    tag = FETCH(start_velocity, i).w + float(met);
#else
    bool kept = FETCH(constraint, i).xyz != vec3(0.0);
    RARELY(kept) leave_contact(i, x.w, x_next, v_next);
    meet_as(i);
    int met = resolve_colliders(FETCH(before_position, i).xyz, x_next, v_next, 0.0);
    x_next -= met_braking;
    tag = FETCH(start_velocity, i).w + float(kept ? max(met, 1) : met);
#endif
  }
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}
