// Contact's term: pins go no farther than they can.
#include "term.glsl"
READ_VEC4(position, unit_position);  // w: inverse mass [1/kg]
layout(std430, binding = slot_term_way) buffer Way { vec4 way[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i < cloth_vertex_count && FETCH(position, i).w == 0.0) way[i].xyz *= uintBitsToFloat(term.pins);
}
