// Contact's term: of each pair that presses and each vertex that it touches, which of the vertex's pairs it is, in an
// order that does not depend on that of threads: so no sum over them does.
#include "term.glsl"
READ_UVEC4(term_pairs, unit_term_pairs);
READ_UVEC2(links, unit_term_links);
READ_UVEC2(term_vertices, unit_term_vertices);  // term_add.glsl
layout(std430, binding = slot_term_ranks) writeonly buffer Ranks { uint ranks[]; };  // by 4 * pair + corner
uniform uint term_capacity;

/// Whether an entry, 4 * pair + corner, comes before another: by the corners of their pairs, or if those are the same,
/// as of a vertex between two solids, by their normals.
bool before(uint one, uint other) {
  for (uint texel = 0u; texel < 2u; ++texel) {
    uvec4 its = FETCH(term_pairs, pair_texels * (one / 4u) + texel);
    uvec4 others = FETCH(term_pairs, pair_texels * (other / 4u) + texel);
    for (int k = 0; k < 4; ++k)
      if (its[k] != others[k]) return its[k] < others[k];
  }
  return false;
}

void main() {
  uint pair = gl_GlobalInvocationID.x;
  if (pair >= term.pressing.w || term.pressing.w > term_capacity) return;
  uvec4 corner = corners_of(FETCH(term_pairs, pair_texels * pair));
  vec4 weight = uintBitsToFloat(FETCH(term_pairs, pair_texels * pair + 2u));
  for (uint k = 0u; k < 4u; ++k) {
    uint own = 4u * pair + k, rank = 0u;
    bool listed = int(corner[k]) < cloth_vertex_count && weight[k] != 0.0;
    uint link = listed ? FETCH_UVEC2(term_vertices, corner[k]).x : 0u;
    for (; link != 0u; link = FETCH_UVEC2(links, link - 1u).x)
      if (before(link - 1u, own)) ++rank;
    ranks[own] = rank;
  }
}
