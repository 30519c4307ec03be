#include "light.glsl"

in vec3 position;
layout(location = uniform_normal) uniform vec3 normal;
layout(location = 0) out vec4 pixel;

void main() {
  const vec3 albedo = vec3(0.60, 0.61, 0.62);
  float distance = length(position - framed.xyz) / framed.w;
  float opacity = 1.0 - smoothstep(2.5, 11.0, distance);
  vec3 lit = to_display(albedo * (ambient(normal) + sunlight(normal)));
  vec3 shown = to_display(albedo * (ambient(normal) + diffuse(position, normal)));
  // Of a plane as background the shadow is left: black that darkens what is behind it as much.
  pixel = clear != 0 ? vec4(vec3(0.0), opacity * (1.0 - shown.g / lit.g)) : vec4(shown, opacity);
}
