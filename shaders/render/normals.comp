// The normals of the streamed frames, as numbers for cloth.vert.
layout(local_size_x = 64) in;
#include "../access.glsl"

READ_VEC4(position, unit_position);
#include "../stream/normal.glsl"
uniform int vertex_count;
layout(std430, binding = slot_normals) writeonly buffer Normals { vec4 normals[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= vertex_count) return;
  normals[i] = vec4(vertex_normal(i, FETCH(position, i).xyz), 0.0);
}
