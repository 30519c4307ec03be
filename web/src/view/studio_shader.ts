// GLSL of the room: what surfaces reflect, how much of it bodies hide, and soft shadows of the key light. A room that
// is a function costs no texture: one that three.js prefilters took 2.3 s before the first picture in software.
import { ShaderChunk } from "three";

/// The light that comes from a direction, blurred by roughness: a pale floor, a sky, a window and a strip at the back.
export const studio = /* glsl */ `
vec3 studio(vec3 way, float roughness) {
  #if NUM_HEMI_LIGHTS > 0
    vec3 sky = hemisphereLights[0].skyColor * RECIPROCAL_PI, ground = hemisphereLights[0].groundColor * RECIPROCAL_PI;
    vec3 light = mix(ground, sky, smoothstep(-0.5 - roughness, 0.5 + roughness, way.y));
    float soft = 0.12 + 0.75 * roughness;
    float window = smoothstep(0.86 - soft, 0.86 + 0.4 * soft, dot(way, vec3(-0.62, 0.55, 0.56)));
    float strip = smoothstep(0.9 - soft, 0.9 + 0.4 * soft, dot(way, vec3(0.45, 0.35, -0.82)));
    return light + sky * (2.6 * window + 1.4 * strip) * (1.0 - 0.65 * roughness);
  #else
    return vec3(0.0);
  #endif
}
`;

export const occlusion = /* glsl */ `
uniform vec4 occluders[4];

// Share of the sky that spheres leave visible to a surface: closed form of a fully visible sphere, clamped.
float skyLeft(vec3 position, vec3 normal) {
  float left = 1.0;
  for (int i = 0; i < 4; ++i) {
    if (occluders[i].w <= 0.0) break;
    vec3 towards = occluders[i].xyz - position;
    float squared = max(dot(towards, towards), 1e-8);
    float facing = 0.35 + 0.65 * dot(normal, towards) * inversesqrt(squared);
    left -= 0.85 * max(facing, 0.0) * min(occluders[i].w * occluders[i].w / squared, 1.0);
  }
  return clamp(left, 0.12, 1.0);
}
`;

// The shadow map seen through a B-spline: no edge of its pixels shows, so that shadows have no teeth. Bilinear reads
// give a kernel of 3x3 pixels with four of them, and one of 5x5 with nine (Castano 2013, Shadow mapping summary).
const spline = (reads: 2 | 3): string => {
  const indices = [0, 1, 2].slice(0, reads);
  const read = (x: number, y: number): string =>
    `w${x}.x * w${y}.y * texture(shadowMap, vec3((middle + vec2(p${x}.x, p${y}.y)) / shadowMapSize, shadowCoord.z))`;
  return /* glsl */ `
  vec2 mapped = shadowCoord.xy * shadowMapSize + 0.5;
  vec2 middle = floor(mapped) - 0.5, off = fract(mapped);
  ${
    reads === 2
      ? `vec2 w0 = 3.0 - 2.0 * off, w1 = 1.0 + 2.0 * off, p0 = (2.0 - off) / w0 - 1.0, p1 = off / w1 + 1.0;`
      : `vec2 w0 = 4.0 - 3.0 * off, w1 = vec2(7.0), w2 = 1.0 + 3.0 * off;
  vec2 p0 = (3.0 - 2.0 * off) / w0 - 2.0, p1 = (3.0 + off) / 7.0, p2 = off / w2 + 2.0;`
  }
  shadow = (${indices.flatMap((y) => indices.map((x) => read(x, y))).join(" + ")}) / ${reads === 2 ? "16.0" : "144.0"};`;
};

/// Replaces three.js's reads of shadow maps, which leave grain. Once, before the first program is made.
export function softenShadows(software: boolean): void {
  const fiveReads = /shadow = \(\s*texture\( shadowMap, vec3\( shadowCoord\.xy \+ vogelDiskSample[\s\S]*?\) \* 0\.2;/;
  ShaderChunk.shadowmap_pars_fragment = ShaderChunk.shadowmap_pars_fragment.replace(
    fiveReads,
    spline(software ? 2 : 3),
  );
}

/// Pixels along a side of the shadow map. With the spline they make shadows whose edge is 1 % of the scene wide.
export const shadowSize = (software: boolean): number => (software ? 512 : 1024);
