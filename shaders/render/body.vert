#include "placed.glsl"

out vec3 position;
out vec3 normal;

void main() {
  position = placed_point();
  normal = axes * direction;
  gl_Position = view_projection * vec4(position, 1.0);
}
