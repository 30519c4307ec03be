// Contact's term: the largest share of the way that keeps every pair apart, one for all: what one vertex may not go its
// neighbours should not either, or the cloth between them would be stretched. OF_PINS: of pairs of which no vertex is
// free, pins and bodies; for them the pins wait, and the cloth does not.
#include "term.glsl"
#include "term_radius.glsl"
#include "term_kept.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(way, unit_term_way);
READ_UVEC4(pair_list, unit_surface_pairs);
READ_UINT(chosen, unit_chosen_pairs);  // term_cull.comp

void main() {
  if (gl_GlobalInvocationID.x >= term.reachable.w) return;
  uvec4 pair = FETCH(pair_list, FETCH_UINT(chosen, gl_GlobalInvocationID.x)), corner = corners_of(pair);
  bool edges = is_edges(pair);
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c, ways;
  float size = 0.0, mobility = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    c.x[k] = x.xyz - origin;
    mobility = max(mobility, x.w);
    ways.x[k] = FETCH(way, corner[k]).xyz;
    size = max(size, length(c.x[k]) + length(ways.x[k]));
  }
  float gap = separation(edges, c).gap, radius = radius_of(pair);
#if OF_PINS
  float keep = min(gap, 0.25 * radius);  // no force would push them apart again
#else
  float keep = kept(gap, radius, rounding_at(origin, size));
#endif
  float share = share_apart(edges, c, ways, keep);
#if OF_PINS
  if (share < 1.0 && mobility == 0.0) atomicMin(term.pins, floatBitsToUint(share));
#else
  if (share < 1.0 && mobility > 0.0) atomicMin(term.share, floatBitsToUint(share));
#endif
}
