// Contact, 3 of 4: pushes of the near pairs that touch, at the places and velocities that the step, or the pass before,
// has made.
#include "surface.glsl"
#include "near_pairs.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_start, unit_step_start);
READ_VEC4(body_places, unit_body_places);  // home, motion; friction, restitution, a box's corner
READ_UINT(touching_pairs, unit_chosen_pairs);
// Of each of touching_pairs its PairLoad (elements/surface.glsl): push, impulse, what is left to friction of both.
READ_VEC4(loads_before, unit_pair_loads);
layout(std430, binding = slot_pair_loads) writeonly buffer Loads { vec4 pair_loads[]; };
// Of each near pair two texels: push [m] and its kind (surface.glsl); impulse [m/s], and 1 if the pair shares its
// corners in the next pass. Where both parts give way, both are over what the pair gives [1/kg].
layout(std430, binding = slot_contact_pushes) writeonly buffer Pushes { vec4 contact_pushes[]; };
uniform float friction;  // coefficient between cloths
uniform float mend;      // share of an overlap that the passes of a step remove
uniform int first_pass;  // 1: the first pass of a step
uniform int pushes;      // 1: the pass pushes pairs apart
uniform int rubs;        // 1: the pass brakes what slides
uniform int next_rubs;   // 1: the next pass only brakes; all pairs that have friction left share it

/// Relaxation of passes of friction alone: near 2 they stop sooner what slides.
const float stops_sooner = 1.9;

/// How far a pair that is nearer than it is kept apart, by `overlap` [m], is pushed as a whole step begins [m]; it
/// takes its part of that. The few passes of a step carry too little through many layers; so layers settle where their
/// overlaps tell what they carry, and the passes have only the rest to find. No memory of the step before is needed,
/// and what is too much is taken back. At most eight layers' weight: layers thrown upon each other shall not spring
/// apart.
float first_push(float overlap) {
  float layer = 10.0 * dt * dt;
  return uintBitsToFloat(known.part) < 1.0 ? 0.0 : 2.0 * clamp(overlap, 0.0, 4.0 * layer);
}

/// Share of an overlap that this part of a step mends. Where layers are pressed, it is at least so much that they
/// come a tenth of their distance apart, or the filter would leave them no room to give way.
float mended(float gap, float keep, bool pressed) {
  float mends = mend * uintBitsToFloat(known.part), least = 0.1 * keep;
  return pressed && gap < least ? max(mends, (least - gap) / (keep - gap)) : mends;
}

/// Friction and restitution of a pair: a body's, if it has a corner of one.
vec2 surface_of(uvec4 corner) {
  vec2 found = vec2(friction, 0.0);
  int body = int(max(corner.x, corner.w)) - cloth_vertex_count;
  if (body >= 0) found = FETCH(body_places, 2 * body + 1).xy;
  return found;
}

/// How firmly a pair's two parts are backed; n leads from the second to the first. A body is backed more firmly than
/// any cloth while it presses, or is pressed against.
uvec2 backing_of(uvec4 corner, vec4 weight, bool edges, vec3 n) {
  uvec2 found = uvec2(0u);
  vec3 body_speed = vec3(0.0);
  bvec2 of_body = bvec2(int(corner.x) >= cloth_vertex_count, int(corner.w) >= cloth_vertex_count);
  for (int k = 0; k < 4; ++k) {
    bool of_first = k == 0 || (edges && k == 1);
    uint backing = weight[k] == 0.0 ? 0u : FETCH(vertex_contacts, 2u * corner[k]).z;
    if (of_first) found.x = max(found.x, backing);
    else found.y = max(found.y, backing);
    if (of_first ? of_body.x : of_body.y) body_speed += weight[k] * FETCH(velocity, corner[k]).xyz;
  }
  // The weights of the second part are negative.
  bool presses = dot(body_speed, n) < -least_pressing;
  uint of_pressed = most_backing + 1u;
  if (of_body.x) found.x = presses || found.y > 0u ? of_pressed : 0u;
  if (of_body.y) found.y = presses || found.x > 0u ? of_pressed : 0u;
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
  bool edges = is_edges(pair);
  uvec2 backing = backing_of(corner, weight, edges, apart.xyz);
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    moved += weight[k] * (x.xyz - FETCH(step_start, corner[k]).xyz);
    v += weight[k] * FETCH(velocity, corner[k]).xyz;
    bool of_first = k == 0 || (edges && k == 1), gives_way = of_first ? backing.x <= backing.y : backing.y <= backing.x;
    mobility[k] = gives_way ? weight[k] * x.w : 0.0;
  }
  float give = dot(mobility, weight);
  vec3 push, impulse;
  vec2 surface = surface_of(corner);
  bvec4 gives = notEqual(mobility, vec4(0.0));
  bool first_gives = gives.x || (edges && gives.y), second_gives = (!edges && gives.y) || gives.z || gives.w;
  bool both_give = first_gives && second_gives;
  vec4 before = FETCH(loads_before, gl_GlobalInvocationID.x);
  PairLoad load = PairLoad(before.x, before.y, FrictionLeft(before.z, before.w));
  float part = both_give ? part_of_pair(corner, mobility, give, pushes != 0 ? 1.0 : stops_sooner) : 1.0;
  float keep = kept_apart(corner, weight), begins = 0.0;
  // What pushes a part that must do all of it is a mean of several pairs': nothing of that could be taken back.
  if (first_pass != 0 && both_give) begins = part * first_push(keep - apart.w);
  moved += begins * apart.xyz;
  v += begins / dt * apart.xyz;
  load.push += begins;
  load.impulse += begins / dt;
  load.left.displacement += surface.x * begins;
  load.left.velocity += surface.x * begins / dt;
  float mends = mended(apart.w, keep, max(backing.x, backing.y) > 0u);
  bool acts = surface_contact(apart.xyz, apart.w, moved, v, keep, surface.x, surface.y, mends, part, pushes != 0,
                              rubs != 0, load, push, impulse);
  push += begins * apart.xyz;
  impulse += begins / dt * apart.xyz;
  acts = acts && give > 0.0;
  bool shares = acts || (next_rubs != 0 && (load.left.displacement > 0.0 || load.left.velocity > 0.0));
  push /= both_give ? give : 1.0;
  impulse /= both_give ? give : 1.0;
  float pushed = pushes_one + (backing.x != backing.y ? float(max(backing.x, backing.y)) : 0.0);
  if (!first_gives) pushed = -pushed;
  contact_pushes[2u * item] = vec4(push, !acts ? no_push : both_give ? pushes_both : pushed);
  contact_pushes[2u * item + 1u] = vec4(impulse, shares ? 1.0 : 0.0);
  if (acts)
    pair_loads[gl_GlobalInvocationID.x] = vec4(load.push, load.impulse, load.left.displacement, load.left.velocity);
}
