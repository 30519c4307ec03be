#include "frame.glsl"

layout(location = 0) in vec3 position;  // [m]
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texture_coordinate;

out Corner {
  vec3 position;
  vec3 normal;
  vec2 texture_coordinate;
} corner;

void main() {
  corner.position = position;
  corner.normal = normal;
  corner.texture_coordinate = texture_coordinate;
  gl_Position = view_projection * vec4(position, 1.0);
}
