// Contact, 2 of 3: pushes of the near pairs that touch, at the places and velocities that the step, or the pass before,
// has made.
#include "surface.glsl"
#include "near_pairs.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_start, unit_step_start);
READ_VEC4(body_places, unit_body_places);  // home, motion; friction, restitution, a box's corner
READ_UINT(touching_pairs, unit_chosen_pairs);
READ_UVEC2(friction_before, unit_friction_left);  // of each of touching_pairs
layout(std430, binding = slot_friction_left) writeonly buffer Left { vec2 friction_left[]; };
// Of each near pair two texels: push [units of length] and its kind (surface.glsl); impulse [units of speed], and 1 if
// the pair shares its corners in the next pass.
layout(std430, binding = slot_contact_pushes) writeonly buffer Pushes { vec4 contact_pushes[]; };
uniform float friction;  // of cloths
uniform float mend;      // share of an overlap that the passes of a step remove
uniform int rubs;        // 1: a pass of friction alone
uniform int next_rubs;   // 1: the next pass is one, shared by all pairs that have friction left

/// Friction and restitution of a pair: a body's, if it has a corner of one.
vec2 surface_of(uvec4 corner) {
  vec2 found = vec2(friction, 0.0);
  int body = int(max(corner.x, corner.w)) - cloth_vertex_count;
  if (body >= 0) found = FETCH(body_places, 2 * body + 1).xy;
  return found;
}

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].touching) return;
  uint item = FETCH_UINT(touching_pairs, gl_GlobalInvocationID.x);
  uvec4 pair = FETCH(near_pairs, 3u * item);
  vec4 apart = uintBitsToFloat(FETCH(near_pairs, 3u * item + 1u));
  vec4 weight = uintBitsToFloat(FETCH(near_pairs, 3u * item + 2u));
  uvec4 corner = corners_of(pair);
  vec3 moved = vec3(0.0), v = vec3(0.0);
  vec4 mobility;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    moved += weight[k] * (x.xyz - FETCH(step_start, corner[k]).xyz);
    v += weight[k] * FETCH(velocity, corner[k]).xyz;
    mobility[k] = weight[k] * x.w;
  }
  float give = dot(mobility, weight);
  vec3 push, impulse;
  vec2 surface = surface_of(corner);
  bvec4 gives = notEqual(mobility, vec4(0.0)), first = bvec4(true, is_edges(pair), false, false);
  bool both_give = (gives.x || (first.y && gives.y)) && ((!first.y && gives.y) || gives.z || gives.w);
  vec2 before = uintBitsToFloat(FETCH_UVEC2(friction_before, gl_GlobalInvocationID.x));
  FrictionLeft left = FrictionLeft(before.x, before.y);
  float part = rubs != 0 ? part_that_rubs(corner, mobility, give) : 1.0 / crowd(corner, mobility, 0u);
  if (!both_give) part = 1.0;
  bool acts = surface_contact(apart.xyz, apart.w, moved, v, kept_apart(corner, weight), surface.x, surface.y,
                              mend * uintBitsToFloat(known.part), part, rubs != 0, left, push, impulse);
  acts = acts && give > 0.0;
  bool shares = acts || (next_rubs != 0 && (left.displacement > 0.0 || left.velocity > 0.0));
  push *= units_of_length() / (both_give ? give : 1.0);
  impulse *= units_of_speed() / (both_give ? give : 1.0);
  contact_pushes[2u * item] = vec4(push, !acts ? no_push : both_give ? pushes_both : pushes_one);
  contact_pushes[2u * item + 1u] = vec4(impulse, shares ? 1.0 : 0.0);
  if (acts) friction_left[gl_GlobalInvocationID.x] = vec2(left.displacement, left.velocity);
}
