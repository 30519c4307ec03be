// A step that may be long for contact is gone in pieces (advance.comp). Before them: the way of each vertex in the
// step.
#include "surface.glsl"
READ_VEC4(position, unit_position);  // at the step's end; w: inverse mass [1/kg]
READ_VEC4(velocity, unit_velocity);
READ_VEC4(step_start, unit_step_start);
layout(std430, binding = slot_path) writeonly buffer Path { vec4 path[]; };  // advance.comp

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) control.gone = floatBitsToUint(0.0);
  if (i >= changing_vertex_count) return;
  vec4 end = FETCH(position, i);
  vec3 way = end.xyz - FETCH(step_start, i).xyz;
  float size = length(way);
  if (size > 0.0 && size < 1e30) {
    atomicMax(control.longest, floatBitsToUint(size));
    if (i >= cloth_vertex_count) atomicMax(control.longest_of_bodies, floatBitsToUint(size));
  }
  path[i] = end.w > 0.0 ? vec4(way / dt - FETCH(velocity, i).xyz, end.w) : end;
}
