// One directional light with a soft shadow, and a sky brighter than the ground.
#include "frame.glsl"

layout(binding = unit_shadow_map) uniform sampler2DShadow shadow_map;

// Share of the light that arrives, [0, 1]. The point is moved off the surface by a few texels of the shadow map, so
// that the surface does not shadow itself.
float light_reaching(vec3 position, vec3 normal) {
  float texel = 2.0 * framed.w / float(textureSize(shadow_map, 0).x);  // [m]
  vec4 clip = light_view_projection * vec4(position + 3.0 * texel * normal, 1.0);
  vec3 at = 0.5 * clip.xyz + 0.5;
  float sum = 0.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      vec2 offset = 1.5 * vec2(x, y) / vec2(textureSize(shadow_map, 0));
      sum += texture(shadow_map, vec3(at.xy + offset, min(at.z, 1.0)));
    }
  return sum / 25.0;
}

vec3 ambient(vec3 normal) {
  const vec3 sky = vec3(0.46, 0.50, 0.56), ground = vec3(0.22, 0.21, 0.20);
  return mix(ground, sky, 0.5 + 0.5 * normal.y);
}

// Of a surface that nothing shades.
vec3 sunlight(vec3 normal) {
  const vec3 sun = vec3(0.86, 0.82, 0.76);
  return sun * max(dot(normal, to_light.xyz), 0.0);
}

vec3 diffuse(vec3 position, vec3 normal) {
  vec3 light = sunlight(normal);
  return light.g > 0.0 ? light * light_reaching(position, normal) : light;
}

// Linear light in the encoding of an sRGB display.
vec3 to_display(vec3 light) {
  vec3 c = clamp(light, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}
