#include "light.glsl"

in vec3 position;
layout(location = uniform_normal) uniform vec3 normal;
layout(location = 0) out vec4 pixel;

void main() {
  const vec3 albedo = vec3(0.60, 0.61, 0.62);
  float distance = length(position - framed.xyz) / framed.w;
  float opacity = 1.0 - smoothstep(2.5, 11.0, distance);
  pixel = vec4(to_display(albedo * (ambient(normal) + diffuse(position, normal))), opacity);
}
