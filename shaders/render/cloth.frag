// Fabric: diffuse light times the cloth's colour and texture, light shining through, and a sheen at grazing angles.
#include "light.glsl"

in Surface {
  vec3 position;
  vec3 normal;
  vec2 texture_coordinate;
} surface;
flat in float back;

layout(location = uniform_color) uniform vec3 color;   // linear
layout(location = uniform_pattern) uniform int pattern;  // 0 plain, 1 weave, 2 checker, 3 stripes
layout(location = 0) out vec4 pixel;

// How much of a pattern with this many repeats is visible, [0, 1]: it fades before it flickers, where a repeat is about
// a pixel.
float visible(vec2 repeats) {
  vec2 per_pixel = fwidth(repeats);
  return 1.0 - smoothstep(0.35, 0.9, max(per_pixel.x, per_pixel.y));
}

// Threads that go over and under each other, brightest where they arch.
float weave(vec2 at) {
  vec2 thread = at * 56.0;
  vec2 inside = fract(thread) - 0.5;
  bool warp_on_top = mod(floor(thread.x) + floor(thread.y), 2.0) < 0.5;
  vec2 along_across = warp_on_top ? inside.yx : inside;
  float arch = cos(3.14159 * along_across.x) * (1.0 - 1.6 * along_across.y * along_across.y);
  return mix(0.84, 0.62 + 0.38 * arch, visible(thread));
}

float checker(vec2 at) {
  vec2 cell = at * 8.0;
  return mod(floor(cell.x) + floor(cell.y), 2.0) < 0.5 ? 1.0 : 0.62;
}

float stripes(vec2 at) { return fract(at.x * 10.0) < 0.5 ? 1.0 : 0.62; }

vec3 fabric(vec2 at) {
  float shade = 1.0;
  if (pattern == 1) shade = weave(at);
  if (pattern == 2) shade = checker(at);
  if (pattern == 3) shade = stripes(at);
  return mix(color, 0.9 * color + 0.04, back) * shade;
}

void main() {
  vec3 to_eye = normalize(eye.xyz - surface.position);
  // Where the normals of a fold's corners cancel each other there is none.
  float size = length(surface.normal);
  vec3 normal = size > 0.0 ? surface.normal / size : to_eye;
  vec3 albedo = fabric(surface.texture_coordinate);
  vec3 through = 0.25 * diffuse(surface.position, -normal);
  float grazing = pow(1.0 - clamp(dot(normal, to_eye), 0.0, 1.0), 4.0);
  vec3 sheen = 0.10 * grazing * (0.5 * color + 0.5);
  pixel = vec4(to_display(albedo * (ambient(normal) + diffuse(surface.position, normal) + through) + sheen), 1.0);
}
