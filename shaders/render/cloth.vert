#include "frame.glsl"

layout(location = attribute_position) in vec3 position;  // [m]
layout(location = attribute_normal) in vec3 normal;
layout(location = attribute_texture_coordinate) in vec2 texture_coordinate;

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
