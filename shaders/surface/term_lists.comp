// Contact's term: of each vertex that is touched, the list of its pairs, in the order of their ranks (term_ranks.comp).
#include "term.glsl"
READ_UVEC2(links, unit_term_links);
READ_UINT(touched, unit_term_touched);
READ_UINT(ranks, unit_term_ranks);
// In: term_add.glsl. Out: where the vertex's list begins, and its length.
layout(std430, binding = slot_term_vertices) coherent buffer Vertices { uvec2 at_vertex[]; };
layout(std430, binding = slot_term_entries) writeonly buffer Entries { uint entries[]; };  // 4 * pair + corner
uniform uint term_capacity;

void main() {
  if (gl_GlobalInvocationID.x >= term.touched.w || term.pressing.w > term_capacity) return;
  uint vertex = FETCH_UINT(touched, gl_GlobalInvocationID.x);
  uvec2 listed = at_vertex[vertex];
  uint first = atomicAdd(term.entries, listed.y);
  for (uint link = listed.x; link != 0u; link = FETCH_UVEC2(links, link - 1u).x)
    entries[first + FETCH_UINT(ranks, link - 1u)] = link - 1u;
  at_vertex[vertex] = uvec2(first, listed.y);
}
