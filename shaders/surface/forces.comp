// Contact, 2 of 3: pushes of the near pairs that touch, on the places and velocities that the step, or the pass
// before, has made. Each corner takes its share by inverse mass and weight, which keeps momentum.
#include "surface.glsl"
#include "near_pairs.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_start, unit_step_start);
READ_VEC4(body_places, unit_body_places);  // home, motion; friction, restitution
layout(std430, binding = slot_friction_left) buffer Left { vec2 friction_left[]; };  // of each of chosen_pairs
uniform float friction;                    // of cloths
uniform float mend;     // share of an overlap that the passes of a step remove
uniform int rubs;       // 1: a pass of friction alone
uniform int next_rubs;  // 1: the next pass is one, shared by all pairs that have friction left

/// Friction and restitution of a pair: a body's, if it has a corner of one.
vec2 surface_of(uvec4 corner) {
  vec2 found = vec2(friction, 0.0);
  int body = int(max(corner.x, corner.w)) - cloth_vertex_count;
  RARELY(body >= 0) found = FETCH(body_places, 2 * body + 1).xy;
  return found;
}

/// What a part must do that meets one which gives no way: all of it. A vertex that several such pairs push takes their
/// mean, weighted by how near their contact is to it.
void give_way(uvec4 corner, vec4 weight, vec4 mobility, vec3 push, vec3 impulse) {
  for (int k = 0; k < 4; ++k)
    if (mobility[k] != 0.0) {
      add(corner[k], 8, weight[k] * push * units_of_length());
      add(corner[k], 12, weight[k] * impulse * units_of_speed());
      atomicAdd(sums[SUMS * int(corner[k]) + 11], weight_in_units(weight[k]));
    }
}

void main() {
  if (gl_GlobalInvocationID.x >= known.step_counts[turn].touching) return;
  uint item = chosen_pairs[gl_GlobalInvocationID.x];
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
  if (!(give > 0.0)) return;
  bvec4 gives = notEqual(mobility, vec4(0.0)), first = bvec4(true, is_edges(pair), false, false);
  bool both_give = (gives.x || (first.y && gives.y)) && ((!first.y && gives.y) || gives.z || gives.w);
  vec2 before = friction_left[gl_GlobalInvocationID.x];
  FrictionLeft left = FrictionLeft(before.x, before.y);
  float part = !both_give ? 1.0 : rubs != 0 ? part_that_rubs(corner, mobility, give) : 1.0 / crowd(corner, mobility, 3);
  bool acts = surface_contact(apart.xyz, apart.w, moved, v, kept_apart(corner, weight), surface.x, surface.y,
                              mend * uintBitsToFloat(known.part), part, rubs != 0, left, push, impulse);
  RARELY(acts || (next_rubs != 0 && (left.displacement > 0.0 || left.velocity > 0.0)))
    for (int k = 0; k < 4; ++k)
      if (corner[k] < uint(cloth_vertex_count))
        atomicAdd(sums[SUMS * int(corner[k]) + 15], next_rubs != 0 ? weight_in_units(weight[k]) : 1);
  RARELY(acts) {
    friction_left[gl_GlobalInvocationID.x] = vec2(left.displacement, left.velocity);
    if (!both_give) {
      give_way(corner, weight, mobility, push, impulse);
    } else {
      push *= units_of_length() / give;
      impulse *= units_of_speed() / give;
      for (int k = 0; k < 4; ++k)
        if (mobility[k] != 0.0) {
          add(corner[k], 0, mobility[k] * push);
          add(corner[k], 4, mobility[k] * impulse);
        }
    }
  }
}
