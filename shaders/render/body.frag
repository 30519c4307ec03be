#include "light.glsl"

in vec3 position;
in vec3 normal;
layout(location = 0) out vec4 pixel;

void main() {
  const vec3 albedo = vec3(0.42, 0.47, 0.52);
  vec3 n = normalize(gl_FrontFacing ? normal : -normal);  // solids show only their front
  vec3 to_eye = normalize(eye.xyz - position);
  vec3 halfway = normalize(to_light.xyz + to_eye);
  float gloss = 0.12 * pow(max(dot(n, halfway), 0.0), 40.0) * light_reaching(position, n);
  pixel = vec4(to_display(albedo * (ambient(n) + diffuse(position, n)) + gloss), 1.0);
}
