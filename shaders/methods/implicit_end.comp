// Implicit Euler, once per step: the new state, after rebounds and after colliders that implicit_start did not foresee;
// and the state in which each contact begins the next step.
#include "implicit_euler.glsl"
#include "implicit_friction.glsl"
#include "step_end.glsl"
#include "../collide/colliders.glsl"
READ_VEC4(before_position, unit_before_position);  // the state at the step's start
READ_VEC4(before_velocity, unit_before_velocity);
READ_VEC4(start_velocity, unit_start_velocity);  // w: number of vertices touched
READ_VEC4(residual, unit_residual);
READ_VEC4(surface, unit_surface);
READ_VEC4(constraint, unit_constraint);
layout(std430, binding = slot_grip) buffer Grip { vec4 grip[]; };

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

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 x_next, v_next;
  float tag = FETCH(before_velocity, i).w;
  if (x.w == 0.0) {
    follow_motion(i, FETCH(before_position, i).xyz, tag, END_ROW, x_next, v_next);
  } else {
    bool kept = FETCH(constraint, i).xyz != vec3(0.0);
    x_next = x.xyz;
    v_next = FETCH(velocity, i).xyz;
    RARELY(kept) leave_contact(i, x.w, x_next, v_next);
    meet_as(i);
    int met = resolve_colliders(FETCH(before_position, i).xyz, x_next, v_next, 0.0);
    x_next -= met_braking;
    tag = FETCH(start_velocity, i).w + float(kept ? max(met, 1) : met);
  }
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}
