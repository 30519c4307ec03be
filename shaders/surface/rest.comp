// Pair search, 9 of 10: marks pairs of two parts of one cloth that are nearer to each other at rest than the thickness:
// no force keeps them apart.
#include "surface.glsl"
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth
layout(std430, binding = slot_surface_pairs) buffer Pairs { uvec4 list[]; };

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.pairs, pair_capacity)) return;
  uvec4 pair = list[item], corner = corners_of(pair);
  vec4 origin = FETCH(rest_position, corner.x);
  bool one_cloth = all(lessThan(corner, uvec4(cloth_vertex_count)));
  Corners c;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(rest_position, corner[k]);
    one_cloth = one_cloth && x.w == origin.w;
    c.x[k] = x.xyz - origin.xyz;
  }
  if (one_cloth && separation(is_edges(pair), c).gap < thickness) list[item].y = pair.y | no_force_bit;
}
