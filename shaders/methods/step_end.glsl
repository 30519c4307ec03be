// The end of a step: writes the new state, and asks for new neighbour lists if the vertex went too far.
layout(std430, binding = slot_next_position) writeonly buffer NextPosition { vec4 next_position[]; };
layout(std430, binding = slot_next_velocity) writeonly buffer NextVelocity { vec4 next_velocity[]; };
#ifdef SELF_COLLISION
#include "../collide/neighbours.glsl"
READ_VEC4(position_when_built, unit_position_when_built);
uniform float skin;  // [m]
#endif

void end_step(int i, vec4 x_next, vec4 v_next) {
  next_position[i] = x_next;
  next_velocity[i] = v_next;
#ifdef SELF_COLLISION
  vec3 moved = x_next.xyz - FETCH(position_when_built, i).xyz;
  if (dot(moved, moved) > 0.25 * skin * skin) rebuild_groups = uint((vertex_count + SLICE_SIZE - 1) / SLICE_SIZE);
#endif
}
