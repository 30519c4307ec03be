// Implicit Euler, once per time step: shortens the first estimate to the share that the line search found best, so that
// it is never worse than standing still, and puts the vertices there.
#include "implicit_euler.glsl"
#define SUMS_AT_ONCE SUMS
#include "group_sums.glsl"
READ_VEC4(start_position, unit_start_position);
READ_VEC4(group_sums, unit_group_sums);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_estimate) buffer Estimate { vec4 estimate[]; };
layout(std430, binding = slot_guess) buffer Guess { vec4 guess[]; };  // of the change of the estimate
#include "implicit_total.glsl"
#include "implicit_share.glsl"

void main() {
  vec4 found[SUMS];
  read_totals(found);
  float share = best_share(found);
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 start = FETCH(start_position, i);
  vec3 whole = estimate[i].xyz, u = start.w == 0.0 ? whole : share * whole;
  estimate[i] = vec4(u, 0.0);
  guess[i].xyz += whole - u;
  next_position[i] = vec4(start.xyz + dt * u, start.w);
}
