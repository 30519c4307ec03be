// GLSL spliced into three.js materials: decoding of q16 vertices, the glaze of bodies, the ground and casters.

/// A vertex of the cloth. Of the frame as it came, attribute `q16`: position as u16 x 3 and two i8 of an octahedral
/// normal, as four normalised 16-bit words. With SMOOTH, of the finer mesh of smooth_cloth.ts.
export const decodeParameters = /* glsl */ `
#ifdef SMOOTH
attribute vec4 shade;
uniform float pixel;  // 2 over the picture's height [1 / CSS pixels]

// A hem is more than a pixel thick: it grows along its normals.
vec3 decodePosition() {
  float away = isOrthographic ? 0.0 : -(viewMatrix * vec4(position, 1.0)).z;
  return position + shade.z * 0.7 * pixel * away / projectionMatrix[1][1] * normal;
}
vec3 decodeNormal() { return normalize(normal); }
#else
attribute vec4 q16;
uniform vec3 boxMinimum;
uniform vec3 boxExtent;

vec3 decodePosition() { return boxMinimum + boxExtent * q16.xyz; }

vec3 decodeNormal() {
  float word = floor(q16.w * 65535.0 + 0.5);
  vec2 bytes = vec2(mod(word, 256.0), floor(word / 256.0));
  vec2 e = max((bytes - 256.0 * step(127.5, bytes)) / 127.0, -1.0);
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return normalize(n);
}
#endif
`;

export const fabricVertexParameters = /* glsl */ `
${decodeParameters}
attribute vec2 textureCoordinate;
attribute float field;
varying float vField;
uniform vec2 size;
uniform vec3 lightDirection;
varying vec2 vCloth;
varying vec3 vWorld;
varying vec2 vShade;  // light that the cloth keeps from its front and back
`;

// A back face lit from behind must move its shadow test towards the light too, else it shadows itself in stripes.
export const fabricShadowNormal = /* glsl */ `
transformedNormal *= dot(objectNormal, lightDirection) < 0.0 ? -1.0 : 1.0;
`;

/// A glazed body: a soft highlight of the key light, and the room in it, most at grazing angles.
export const porcelain = /* glsl */ `
vec3 viewDirection = normalize(vViewPosition);
float rim = pow(1.0 - saturate(dot(viewDirection, normal)), 4.0);
outgoingLight += (0.035 + 0.4 * rim) * studio(inverseTransformDirection(reflect(-viewDirection, normal), viewMatrix), 0.2);
#if NUM_DIR_LIGHTS > 0
  vec3 halfway = normalize(viewDirection + directionalLights[0].direction);
  float lit = smoothstep(0.0, 0.25, reflectedLight.directDiffuse.g);  // no highlight where the light is hidden
  outgoingLight += 0.35 * lit * pow(saturate(dot(normal, halfway)), 60.0);
#endif
`;

/// A disc that fades into the backdrop, with the soft shadow of ground_shadow.ts. Colours are sRGB as in the style
/// sheet, and there is no lighting: the ground covers most of the picture, so a fragment must cost next to nothing.
export const groundVertex = /* glsl */ `
uniform mat4 shadowMatrix;
uniform float fadeRadius;
varying vec2 vDisc;
varying vec2 vLines;
varying vec2 vMask;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vDisc = position.xy;
  vLines = position.xy * fadeRadius * 4.0;
  vMask = (shadowMatrix * world).xy;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

export const groundFragment = /* glsl */ `
uniform vec3 groundColor;
uniform vec3 shadowColor;
uniform vec3 lineColor;
uniform sampler2D shadowMask;
varying vec2 vDisc;
varying vec2 vLines;
varying vec2 vMask;

void main() {
  vec3 color = groundColor;
  #ifdef LINES  // every 0.25 m
    vec2 width = fwidth(vLines);
    vec2 line = clamp(1.3 - abs(fract(vLines - 0.5) - 0.5) / width, 0.0, 1.0) * clamp(1.6 - 4.0 * width, 0.0, 1.0);
    color = mix(color, lineColor, 0.5 * max(line.x, line.y));
  #endif
  vec2 off = abs(vMask - 0.5);
  if (max(off.x, off.y) < 0.5) color = mix(color, shadowColor, 0.62 * texture2D(shadowMask, vMask).r);
  float fade = max(1.0 - dot(vDisc, vDisc), 0.0);
  // against visible bands in the gradient
  float noise = fract(52.98 * fract(dot(gl_FragCoord.xy, vec2(0.0671, 0.00584)))) - 0.5;
  gl_FragColor = vec4(color, fade * fade + 0.012 * noise);
}`;

/// Draws a caster of ground_shadow.ts.
export const casterFragment = "void main() { gl_FragColor = vec4(1.0); }";
