// The classical Runge-Kutta method of order 4: four evaluations of the forces per step, each a dispatch of this kernel
// with STAGE 1 to 4. Hairer, Norsett & Wanner 1993, section II.1. Each stage reads what the stage before wrote;
// contacts are found once, from the state at the step's start, and applied at its end.
#include "gather.glsl"
#include "step_end.glsl"
#if STAGE > 1
READ_VEC4(start_position, unit_start_position);
READ_VEC4(start_velocity, unit_start_velocity);
#else
#define start_position position
#define start_velocity velocity
#endif
#if STAGE < 4
// xyz: this stage's acceleration [m/s^2]
layout(std430, binding = slot_slope) writeonly buffer Slope { vec4 slope[]; };
#else
READ_VEC4(slope_1, unit_slope_1);
READ_VEC4(slope_2, unit_slope_2);
READ_VEC4(slope_3, unit_slope_3);
#define START_POSITION start_position
#define START_VELOCITY start_velocity
#include "../collide/colliders.glsl"
#ifdef SELF_COLLISION
#include "../collide/self_contact.glsl"
#endif
#endif

#if STAGE < 4
/// The state for the next stage: half a step on, or a whole step.
void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(start_position, i), v = FETCH(start_velocity, i);
  vec3 x_next, v_next;
  if (x.w == 0.0) {
    follow_motion(i, x.xyz, v.w, STAGE < 3 ? 1 : END_ROW, x_next, v_next);
  } else {
    vec4 x_now = FETCH(position, i), v_now = FETCH(velocity, i);
    vec3 a = acceleration(i, x_now, v_now.xyz, STAGE - 1 - (STAGE > 2 ? 1 : 0));
    float ahead = STAGE < 3 ? 0.5 * dt : dt;
    x_next = x.xyz + ahead * v_now.xyz;
    v_next = v.xyz + ahead * a;
    slope[i] = vec4(a, 0.0);
  }
  next_position[i] = vec4(x_next, x.w);
  next_velocity[i] = vec4(v_next, v.w);
}
#else
/// The weighted mean of the slopes. With each stage's velocity written out, the position needs no velocity but the
/// first.
int move_freely(int i, vec4 x, vec4 v, out vec3 x_next, out vec3 v_next) {
  vec3 a1 = FETCH(slope_1, i).xyz, a2 = FETCH(slope_2, i).xyz, a3 = FETCH(slope_3, i).xyz;
  vec3 a4 = acceleration(i, FETCH(position, i), FETCH(velocity, i).xyz, END_ROW);
  vec3 push = vec3(0.0), impulse = vec3(0.0);
  int contacts = 0;
#ifdef SELF_COLLISION
  contacts = self_contacts(i, x, v, push, impulse);
#endif
  v_next = v.xyz + dt / 6.0 * (a1 + 2.0 * (a2 + a3) + a4) + impulse;
  x_next = x.xyz + push + dt * (v.xyz + impulse + dt / 6.0 * (a1 + a2 + a3));
  meet_as(i);
  contacts += resolve_colliders(x.xyz, x_next, v_next, 0.0);
  x_next -= met_braking;
  return contacts;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(start_position, i), v = FETCH(start_velocity, i);
  vec3 x_next, v_next;
  float tag = v.w;
  if (x.w == 0.0) follow_motion(i, x.xyz, v.w, END_ROW, x_next, v_next);
  else tag = float(move_freely(i, x, v, x_next, v_next));
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}
#endif
