// Implicit Euler, once a step: the new state, after friction from the impulse that the contacts' filter kept out of the
// solution, and after colliders that nobody foresaw.
#include "implicit_euler.glsl"
#include "step_end.glsl"
#include "../collide/colliders.glsl"
READ_VEC4(before_position, 9);  // the state at the step's start
READ_VEC4(before_velocity, 10);
READ_VEC4(start_velocity, 11);  // w: vertices touched
READ_VEC4(residual, 12);
READ_VEC4(surface, 13);
READ_VEC4(constraint, 14);
READ_VEC4(block_a, 4);
READ_VEC4(block_b, 5);

/// Friction and rebound of a vertex that was kept on a surface. Stopping it takes the impulse J sliding, the springs to its
/// neighbours included; friction has the contact's impulse times the coefficient. In a long step what friction takes must
/// not be travelled.
void rub(int i, inout vec3 x, inout vec3 v) {
  vec4 contact = FETCH(constraint, i);
  vec3 normal = contact.xyz;
  float impulse = max(-dot(FETCH(residual, i).xyz, normal) , 0.0);  // [kg m/s]
  vec4 under = FETCH(surface, i);
  vec3 sliding = v - under.xyz;
  sliding -= normal * dot(normal, sliding);
  float needed = length(block_times(FETCH(block_a, i).xyz, FETCH(block_b, i).xyz, sliding));
  vec3 taken = sliding * min(1.0, under.w * impulse / max(needed, 1e-30));
  x -= dt * taken;
  v += normal * contact.w - taken;
}

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 x_next, v_next;
  float tag = FETCH(before_velocity, i).w;
  if (x.w == 0.0) {
    follow_motion(i, tag, END_ROW, x_next, v_next);
  } else {
    bool kept = FETCH(constraint, i).xyz != vec3(0.0);
    x_next = x.xyz;
    v_next = FETCH(velocity, i).xyz;
    RARELY(kept) rub(i, x_next, v_next);
    int met = resolve_colliders(FETCH(before_position, i).xyz, x_next, v_next, 0.0);
    tag = FETCH(start_velocity, i).w + float(kept ? max(met, 1) : met);
  }
  end_step(i, vec4(x_next, x.w), vec4(v_next, tag));
}
