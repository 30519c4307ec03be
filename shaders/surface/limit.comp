// The filter, 2 of 3: each near pair shortens the steps of its corners to what they can take without crossing a plane
// that divides the pair. PASS 0: the first, over all near pairs, from the step's start; 1: another, over those that
// could meet; 2: after the last of them, takes the approaching velocity, along their normals, from the pairs whose
// planes limit a step the most.
#include "surface.glsl"
#include "near_pairs.glsl"
#include "vertex_contacts.glsl"
#include "step_limits.glsl"
READ_VEC4(position, unit_position);  // so far; w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_target, unit_step_target);
layout(std430, binding = slot_step_limits) coherent buffer Limits { uint limits[]; };
layout(std430, binding = slot_near_pairs) writeonly buffer NearPairs { uvec4 near_list[]; };
// Pairs that push, and from pair_capacity on, in place of those that cull.comp kept, those that could meet.
layout(std430, binding = slot_chosen_pairs) buffer Chosen { uint chosen_pairs[]; };
uniform float held_part;  // of what is left of their steps, that pins and bodies go for in this pass

uint limit_of_corner(uint corner, float inverse_mass) {
  return uint(limit_of(int(corner), inverse_mass, FETCH(velocity, corner).w));
}

/// How near the filter lets a vertex come to a plane that divides a pair, as a share of the thickness.
const float least_room = 0.02;

void shorten(uvec4 corner, vec4 shares, vec4 inverse_mass) {
  control.step_counts[turn].cut_vertices = known.step_counts[turn].vertex_groups;
  for (int k = 0; k < 4; ++k) {
    if (corner[k] < uint(cloth_vertex_count)) atomicAdd(at_vertex[corner[k]].shortening, 1u);
    if (shares[k] < 1.0)
      atomicMin(limits[limit_of_corner(corner[k], inverse_mass[k])], floatBitsToUint(shares[k]));
  }
}

#if PASS == 2
#include "speed_units.glsl"

void stop(uvec4 corner, vec4 shares, vec3 n, vec4 weight, vec4 inverse_mass) {
  bool limiting = false;
  float approach = 0.0;
  for (int k = 0; k < 4; ++k) {
    uint least = limits[limit_of_corner(corner[k], inverse_mass[k])];
    limiting = limiting || (shares[k] < 1.0 && floatBitsToUint(shares[k]) == least);
    approach -= weight[k] * dot(n, FETCH(velocity, corner[k]).xyz);
  }
  vec4 mobility = weight * inverse_mass;
  float give = dot(mobility, weight);
  if (!limiting || !(approach > 0.0) || !(give > 0.0)) return;
  vec3 impulse = n * (approach / give);
  float sharers = crowd(corner, mobility);
  for (int k = 0; k < 4; ++k) {
    ivec3 whole = in_units_of_speed(mobility[k] * impulse, sharers);
    for (int axis = 0; axis < 3; ++axis)
      if (whole[axis] != 0) atomicAdd(at_vertex[corner[k]].impulse[axis], whole[axis]);
  }
}
#endif

/// After a pass every pair is on its sides of the plane that divided it before, but for one of a body, whose corners
/// nothing stops. It may meet, then.
void count_if_forced(bool edges, Corners now, vec3 n, uvec4 corner) {
  bool of_body = int(max(corner.x, corner.w)) >= cloth_vertex_count;
  if (of_body && gap_along(edges, now, n) <= 0.0) atomicAdd(control.forced, 1u);
}

void main() {
  uint item = gl_GlobalInvocationID.x;
#if PASS == 0
  if (item >= known.step_counts[turn].near) return;
#else
  if (item >= known.step_counts[turn].meeting) return;
  item = chosen_pairs[pair_capacity + item];
#endif
  uvec4 pair = FETCH(near_pairs, 3u * item), corner = corners_of(pair);
  bool edges = is_edges(pair);
  vec4 apart = uintBitsToFloat(FETCH(near_pairs, 3u * item + 1u));
  vec4 inverse_mass;
  vec3 origin = FETCH(position, corner.x).xyz, steps[4];
  Corners c;
  float size = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    c.x[k] = x.xyz - origin;
    steps[k] = FETCH(step_target, corner[k]).xyz - x.xyz;
    inverse_mass[k] = x.w;
    size = max(size, length(c.x[k]) + length(steps[k]));
  }
#if PASS == 1
  count_if_forced(edges, c, apart.xyz, corner);
#endif
#if PASS > 0
  Separation now = separation(edges, c);
  apart = vec4(now.n, now.gap);
  near_list[3u * item + 1u] = floatBitsToUint(apart);
#endif
  StepsAlong along;
  for (int k = 0; k < 4; ++k) {
    along.y[k] = dot(apart.xyz, c.x[k]);
    along.d[k] = dot(apart.xyz, steps[k]);
    along.held[k] = int(corner[k]) >= cloth_vertex_count ? 1 : 0;
  }
  float rounding = rounding_at(origin, size), least = max(rounding, least_room * thickness);
#if PASS == 0
  // What this direction divides for the whole step stays divided, whatever parts of it the corners take.
  if (could_meet(edges, along, 2.0 * rounding)) {
    uint place = atomicAdd(control.step_counts[turn].meeting, 1u);
    if (place % uint(GROUP_SIZE) == 0u)
      atomicMax(control.step_counts[turn].meeting_groups, place / uint(GROUP_SIZE) + 1u);
    chosen_pairs[pair_capacity + place] = item;
  }
#endif
  for (int k = 0; k < 4; ++k) {
    float part = inverse_mass[k] == 0.0 ? held_part : 1.0;
    steps[k] *= part;
    along.d[k] *= part;
  }
  if (could_meet(edges, along, rounding)) {
    float plane = dividing_plane(edges, along, rounding);
    vec4 shares;
    for (int k = 0; k < 4; ++k) {
      float side = k == 0 || (edges && k == 1) ? 1.0 : -1.0;
      float room = side * (along.y[k] - plane), away = side * along.d[k];
      shares[k] = along.held[k] != 0 ? 1.0 : share_of_step(room, away, length(steps[k]), rounding, least);
    }
    if (min(min(shares.x, shares.y), min(shares.z, shares.w)) < 1.0) {
#if PASS == 2
      stop(corner, shares, apart.xyz, vec4(now.weight[0], now.weight[1], now.weight[2], now.weight[3]), inverse_mass);
#else
      shorten(corner, shares, inverse_mass);
#endif
    }
  }
}
