#include "frame.glsl"

layout(location = attribute_position) in vec3 unit;  // on the unit sphere
layout(location = uniform_placed) uniform vec4 placed;  // xyz centre [m], w radius [m]

out vec3 position;
out vec3 normal;

void main() {
  position = placed.xyz + placed.w * unit;
  normal = unit;
  gl_Position = view_projection * vec4(position, 1.0);
  // A little deeper than it is: the middles of the triangles of cloth that lies on it are inside it.
  vec4 deeper = view_projection * vec4(position + 0.08 * placed.w * normalize(position - eye.xyz), 1.0);
  gl_Position.z = deeper.z / deeper.w * gl_Position.w;
}
