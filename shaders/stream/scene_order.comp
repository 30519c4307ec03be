// Copies positions from their places in memory (server/model/numbering.h) to the scene's order.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
READ_VEC4(position, unit_position);
READ_UINT(place, unit_places);
layout(std430, binding = slot_in_scene_order) writeonly buffer InSceneOrder { vec4 in_scene_order[]; };
uniform int vertex_count;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i < vertex_count) in_scene_order[i] = FETCH(position, FETCH_UINT(place, i));
}
