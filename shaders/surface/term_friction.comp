// Contact's term: the change of the energy of friction of each pair that presses, at shares of the way, less the work
// that bodies and pins do (term_energy.comp).
#include "term.glsl"
#include "term_radius.glsl"
#include "term_shares.glsl"
READ_VEC4(way, unit_term_way);
READ_VEC4(position, unit_position);
READ_UVEC4(term_pairs, unit_term_pairs);
layout(std430, binding = slot_term_energies) writeonly buffer Energies { vec4 energies[]; };
uniform int first;  // 1: the iterate is where the step begins

/// What bodies and pins do against friction over a share of their way, over the friction that slides [m].
float friction_work(vec3 slid, vec3 driven, float still) {
  float so_far = length(slid);
  return so_far > 0.0 ? friction_stiffness(so_far, still) * dot(slid, driven) : 0.0;
}

void main() {
  if (gl_GlobalInvocationID.x >= term.pressing.w) return;
  uint at = pair_texels * gl_GlobalInvocationID.x;
  uvec4 corner = corners_of(FETCH(term_pairs, at));
  vec4 weight = uintBitsToFloat(FETCH(term_pairs, at + 2u)), slid = uintBitsToFloat(FETCH(term_pairs, at + 4u));
  vec3 n = uintBitsToFloat(FETCH(term_pairs, at + 1u).xyz), origin = FETCH(position, corner.x).xyz;
  vec3 moved = vec3(0.0), driven = vec3(0.0);
  vec4 inverse_mass;
  float size = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    vec3 its_way = weight[k] * FETCH(way, corner[k]).xyz;
    moved += its_way;
    driven += x.w == 0.0 ? its_way : vec3(0.0);
    inverse_mass[k] = x.w;
    size = max(size, length(x.xyz - origin));
  }
  if (corner.x == corner.y) {  // a solid has no corners, and goes a way of its own
    vec3 its_way = dt * uintBitsToFloat(FETCH(term_pairs, at + 5u).xyz);
    moved += its_way;
    driven += its_way;
  }
  float apart = dot(moved, n);
  moved -= n * apart;
  float still = still_way(slid.w, inverse_mass, rounding_at(origin, size)), share = uintBitsToFloat(term.share);
  vec4 direction = slid;
  if (first != 0) slid.xyz = vec3(0.0);
  float before = friction_energy(length(slid.xyz), still);
  vec4 change;
  float so_far = length(slid.xyz), work_before = friction_work(slid.xyz, driven, still);
  for (int s = 0; s < 4; ++s) {
    float part = share * tried[s];
    vec3 there = slid.xyz + part * moved;
    float work = 0.5 * part * (work_before + friction_work(there, driven, still));
    change[s] = slid.w * (friction_energy(length(there), still) - before - work);
  }
  // What the matrix has for friction after the way.
  vec3 after = slid.xyz + share * moved, change_of_way = share * moved;
  float rubs = uintBitsToFloat(FETCH(term_pairs, at + 3u).w), excess = uintBitsToFloat(FETCH(term_pairs, at + 5u).w);
  vec3 along = length(direction.xyz) > 0.0 ? normalize(direction.xyz) : vec3(0.0);
  vec3 taken = (first != 0 ? excess : rubs) * direction.xyz + rubs * change_of_way -
               excess * dot(along, change_of_way) * along;
  // The force that presses is another there, too.
  float along_n = uintBitsToFloat(FETCH(term_pairs, at + 1u).w);
  float presses = dot(uintBitsToFloat(FETCH(term_pairs, at + 3u).xyz), n);
  float slides = presses > 0.0 ? slid.w * max(1.0 - share * along_n * apart / presses, 0.0) : slid.w;
  // What slides was to be braked by so much, and what holds by no more.
  float more = length(taken) - slides, off_by = length(after) < still ? max(more, 0.0) : abs(more);
  // Over what half of the radius would give.
  float whole = 0.5 * stiffness_of(inverse_mass) * thickness;
  ivec2 friction = in_units(slides / whole), off = in_units(off_by / whole);
  if (friction != ivec2(0)) {
    atomicAdd(term.rubs.x, uint(friction.x));
    atomicAdd(term.rubs.y, uint(friction.y));
  }
  if (off != ivec2(0)) {
    atomicAdd(term.rubs.z, uint(off.x));
    atomicAdd(term.rubs.w, uint(off.y));
  }
  energies[gl_GlobalInvocationID.x] = change;
  for (int s = 0; s < 4; ++s) atomicMax(term.largest[s], floatBitsToUint(min(abs(change[s]), 1e30)));
}
