// Contact's term: bodies go the same share of their way as the cloth. Behind the places of cloths.
#include "term.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(way, unit_term_way);
layout(std430, binding = slot_next_position) writeonly buffer Position { vec4 next_position[]; };

void main() {
  int i = cloth_vertex_count + int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  next_position[i] = vec4(FETCH(position, i).xyz + uintBitsToFloat(term.taken) * FETCH(way, i).xyz, 0.0);
}
