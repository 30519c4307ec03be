// Implicit Euler, a few times a step: self-collision after the solve. What it took from the velocities before, the
// springs have given some of back: a long step's springs push layers that lie on each other through each other. All
// pairs at once, from the velocities of the pass before, so that no order matters.
#include "implicit_euler.glsl"
#include "../elements/contact.glsl"
#include "../collide/neighbours.glsl"
READ_VEC4(start_position, unit_start_position);
#define START_POSITION start_position
#define START_VELOCITY velocity
#include "../collide/self_contact.glsl"
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_estimate) writeonly buffer NextEstimate { vec4 next_estimate[]; };  // w: vertices touched

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 start = FETCH(start_position, i), u = FETCH(velocity, i);
  vec3 push = vec3(0.0);  // of the overlap that the one before the solve left: long steps mend it less often
  if (start.w > 0.0) {
    vec3 impulse = vec3(0.0);
    int touched = self_contacts(i, start, u, push, impulse);
    u = vec4(u.xyz + impulse, max(u.w, float(touched)));
  }
  next_position[i] = vec4(start.xyz + push + dt * u.xyz, start.w);
  next_estimate[i] = u;
}
