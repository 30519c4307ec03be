// Contact's term: the listed pairs that may press at the iterate, or with ALONG_WAY on the way from there. A cheap test
// leaves few.
#include "term.glsl"
#include "reach.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
READ_UVEC4(pair_list, unit_surface_pairs);
#if ALONG_WAY
READ_VEC4(way, unit_term_way);
#endif
// Those that may press on the way, and from pair_capacity on those that may at the iterate.
layout(std430, binding = slot_term_chosen) writeonly buffer Chosen { uint chosen[]; };

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.pairs, pair_capacity)) return;
  uvec4 pair = FETCH(pair_list, item), corner = corners_of(pair);
  vec3 origin = FETCH(position, corner.x).xyz;
  Corners c, ahead;
  float mobility = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(position, corner[k]);
    ahead.x[k] = c.x[k] = x.xyz - origin;
    mobility = max(mobility, x.w);
#if ALONG_WAY
    vec3 moved = FETCH(way, corner[k]).xyz;
    ahead.x[k] += moved;
    if (int(corner[k]) < cloth_vertex_count) mobility = max(mobility, dot(moved, moved));  // a pin that moves
#endif
  }
  if (mobility > 0.0 && within_reach(is_edges(pair), c, ahead, thickness)) {
#if ALONG_WAY
    APPEND(reachable, place)
    chosen[place] = item;
#else
    APPEND(kept, place)
    chosen[pair_capacity + place] = item;
#endif
  }
}
