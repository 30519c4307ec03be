// Takes each vertex along the next piece of its step. A piece is so short that no vertex goes farther than the listed
// pairs allow; then pushes and the filter follow, before the next piece. So the search need not reach as far as the
// fastest vertex goes in a step. What changes a velocity on the way changes what is left of the way.
#include "surface.glsl"
#include "../methods/motions.glsl"
#define SOLIDS_IN_PIECES
#include "../collide/colliders.glsl"
READ_VEC4(path, unit_path);  // if free: its way less its velocity [m/s]; if held: where it ends [m]; w: inverse mass
READ_VEC4(velocity, unit_velocity);
layout(std430, binding = slot_next_position) buffer Position { vec4 position[]; };
layout(std430, binding = slot_step_start) buffer Start { vec4 piece_start[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer Velocity { vec4 velocity_left[]; };
uniform float most_advance;  // of a vertex in a piece [m]
uniform int piece;  // 0: the first, which begins where the step does; `position` has the step's end then

void main() {
  int i = int(gl_GlobalInvocationID.x);
  float left = 1.0 - uintBitsToFloat(known.gone), longest = uintBitsToFloat(known.longest);
  float most = 0.8 * step_share * uintBitsToFloat(known.flat_query);
  if (piece < piece_count - 1) most = min(most, max(most_advance, longest / float(piece_count)));
  // The filter cuts the steps of what goes too far in the last piece, but not those of bodies: for them it is not the
  // last (SurfaceContact::keep_apart).
  if (piece == piece_count - 1) longest = uintBitsToFloat(known.longest_of_bodies);
  float part = !pairs_are_known() ? 0.0 : longest * left <= most ? left : most / longest;
  if (i == 0) {
    control.part = floatBitsToUint(part);
    control.contact_groups = part > 0.0 ? known.pair_groups : 0u;
  }
  if (i >= changing_vertex_count) return;
  if (piece == 0 && part >= 1.0) return;  // all are where the step ends
  vec4 start = position[i], way = FETCH(path, i);
  if (piece == 0) start = piece_start[i];
  else piece_start[i] = start;
  if (!(part > 0.0)) {  // the method's end of the step is not the filter's
    position[i] = vec4(start.xyz, way.w);
    return;
  }
  bool free = way.w > 0.0;
  vec3 end = free ? start.xyz + (FETCH(velocity, i).xyz + way.xyz) * (part * dt)
                  : part < left ? start.xyz + (way.xyz - start.xyz) * (part / left) : way.xyz;
#if SOLID_ROWS > 0
  if (free) {
    vec3 v = FETCH(velocity, i).xyz;
    piece_begin = 1.0 - left;
    piece_end = piece_begin + part;
    meet_as(i);
    if (resolve_colliders(start.xyz, end, v, 0.0) > 0) {
      end -= met_braking;
      velocity_left[i].xyz = v;
    }
  }
#endif
  position[i] = vec4(end, way.w);
}
