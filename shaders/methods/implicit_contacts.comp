// Implicit Euler, a few times per step: self-collision after the solve. In a long step, springs give back some of the
// velocity that self-collision took before, and push layers that lie on each other through each other. All pairs are
// computed at once from the velocities of the pass before, so that no order matters.
#include "implicit_euler.glsl"
#include "../elements/contact.glsl"
#include "../collide/neighbours.glsl"
READ_VEC4(start_position, unit_start_position);
#define START_POSITION start_position
#define START_VELOCITY velocity
#include "../collide/self_contact.glsl"
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
// w: number of vertices touched
layout(std430, binding = slot_estimate) writeonly buffer NextEstimate { vec4 next_estimate[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 start = FETCH(start_position, i), u = FETCH(velocity, i);
  vec3 push = vec3(0.0);  // of the overlap that the pass before the solve left: long steps mend it less often
  if (start.w > 0.0) {
    vec3 impulse = vec3(0.0);
    int touched = self_contacts(i, start, u, push, impulse);
    u = vec4(u.xyz + impulse, max(u.w, float(touched)));
  }
  next_position[i] = vec4(start.xyz + push + dt * u.xyz, start.w);
  next_estimate[i] = u;
}
