// Contact's term: where the change that a method has solved for would take each vertex, and where bodies have yet to
// go.
#include "term.glsl"
READ_VEC4(position, unit_position);  // the iterate; w: inverse mass [1/kg]
READ_VEC4(change, unit_change);      // of velocity [m/s], of cloths
READ_UVEC2(term_vertices, unit_term_vertices);
READ_VEC4(ends, unit_term_ends);     // of bodies, behind the places of cloths
layout(std430, binding = slot_term_way) writeonly buffer Way { vec4 way[]; };           // [m]
layout(std430, binding = slot_term_target) writeonly buffer Target { vec4 target[]; };  // [m]
layout(std430, binding = slot_term_velocity) writeonly buffer Velocity { vec4 velocity[]; };  // to it in a step [m/s]
uniform int bodies_move;  // 1: some have yet to go

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  vec4 x = FETCH(position, i);
  vec3 moved = vec3(0.0);
  if (i < cloth_vertex_count) moved = dt * FETCH(change, i).xyz;
  else if (bodies_move != 0) moved = FETCH(ends, i).xyz - x.xyz;
  float size = length(moved);
  if (x.w > 0.0) {
    uint length_bits = floatBitsToUint(size < 1e30 ? size : 1e30);
    atomicMax(term.longest, length_bits);
    if (FETCH_UVEC2(term_vertices, i).y > 0u) atomicMax(term.pressed, length_bits);
  }
  way[i] = vec4(moved, x.w);
  target[i] = vec4(x.xyz + moved, x.w);
  velocity[i] = vec4(moved / dt, 0.0);
}
