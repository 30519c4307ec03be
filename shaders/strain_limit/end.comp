// The strain limit, once per step: the corrected positions become the state, and the velocities follow. Where the limit
// cannot be kept, a cloth takes only a share of both (server/model/limit_shares.h).
#include "strain_limit.glsl"
READ_VEC4(velocity, unit_velocity);
READ_VEC4(corrected_position, unit_corrected_position);
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer NextVelocity { vec4 next_velocity[]; };
uniform float dt;                  // [s]
uniform vec2 shares[CLOTH_COUNT];  // of the corrections that each cloth takes: of places, of velocities

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i), v = FETCH(velocity, i);
  vec3 corrected = FETCH(corrected_position, i).xyz, gained = x.w * given[i].xyz / dt;
  vec2 share = shares[int(FETCH(rest_position, i).w)];
  if (share.x < 1.0) corrected = x.xyz + share.x * (corrected - x.xyz);
  next_position[i] = vec4(corrected, x.w);
  next_velocity[i] = vec4(v.xyz + share.y * gained, v.w);
}
