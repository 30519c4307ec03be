#include "placed.glsl"

out vec3 position;
out vec3 normal;

void main() {
  position = placed_point();
  normal = axes * direction;
  gl_Position = view_projection * vec4(position, 1.0);
  // A little deeper than it is where it is round: the middles of the triangles of cloth that lies on it are inside it.
  vec4 deeper = view_projection * vec4(position + 0.08 * placed.w * normalize(position - eye.xyz), 1.0);
  gl_Position.z = deeper.z / deeper.w * gl_Position.w;
}
