// Contact's term: the change of each pair's energy at shares of the way, less the work that bodies and pins do: they go
// on in any case, and a way must not be found bad because they do.
#include "term.glsl"
#include "term_radius.glsl"
#include "term_shares.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(way, unit_term_way);
READ_UVEC4(pair_list, unit_surface_pairs);
READ_UINT(chosen, unit_chosen_pairs);  // term_cull.comp
layout(std430, binding = slot_term_energies) writeonly buffer Energies { vec4 energies[]; };

struct Found {
  float energy;  // [J]
  float work;    // of bodies and pins, over a share of the way [J]
};

Found found_at(bool edges, Corners c, Corners driven, float least, float radius, float stiffness) {
  Separation apart = separation(edges, c);
  float gap = max(apart.gap, least), pushed = 0.0;
  for (int k = 0; k < 4; ++k) pushed -= apart.weight[k] * dot(apart.n, driven.x[k]);
  return Found(contact_energy(gap, radius, stiffness), contact_force(gap, radius, stiffness) * pushed);
}

void main() {
  if (gl_GlobalInvocationID.x >= term.reachable.w) return;
  uvec4 pair = FETCH(pair_list, FETCH_UINT(chosen, gl_GlobalInvocationID.x)), corner = corners_of(pair);
  bool edges = is_edges(pair);
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c, ways, driven;
  vec4 inverse_mass;
  float size = 0.0, longest = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    c.x[k] = x.xyz - origin;
    ways.x[k] = FETCH(way, corner[k]).xyz;
    inverse_mass[k] = x.w;
    driven.x[k] = x.w == 0.0 ? ways.x[k] : vec3(0.0);
    if (x.w > 0.0) longest = max(longest, length(ways.x[k]));
    size = max(size, length(c.x[k]) + length(ways.x[k]));
  }
  float radius = radius_of(pair), stiffness = stiffness_of(inverse_mass), least = rounding_at(origin, size);
  float share = uintBitsToFloat(term.share);
  Found before = found_at(edges, c, driven, least, radius, stiffness);
  vec4 change;
  for (int s = 0; s < 4; ++s) {
    Corners there;
    float part = share * tried[s];
    for (int k = 0; k < 4; ++k) there.x[k] = c.x[k] + ways.x[k] * part;
    Found after = found_at(edges, there, driven, least, radius, stiffness);
    if (after.energy > 0.0) atomicMax(term.pressed, floatBitsToUint(min(longest, 1e30)));
    change[s] = after.energy - before.energy - 0.5 * part * (before.work + after.work);
  }
  energies[gl_GlobalInvocationID.x] = change;
  for (int s = 0; s < 4; ++s) atomicMax(term.largest[s], floatBitsToUint(min(abs(change[s]), 1e30)));
}
