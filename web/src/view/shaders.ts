// GLSL spliced into three.js materials: decoding of q16 vertices, woven textures, sheen, and occlusion by spheres.

/// Vertex attribute `q16`: position as u16 x 3 and two i8 of an octahedral normal, as four normalised 16-bit words.
export const decodeParameters = /* glsl */ `
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
`;

export const fabricVertexParameters = /* glsl */ `
${decodeParameters}
attribute vec2 textureCoordinate;
attribute float field;
varying float vField;
uniform vec2 threads;
uniform vec3 lightDirection;
varying vec2 vCloth;
varying vec3 vWorld;
`;

// A back face lit from behind must move its shadow test towards the light too, else it shadows itself in stripes.
export const fabricShadowNormal = /* glsl */ `
transformedNormal *= dot(objectNormal, lightDirection) < 0.0 ? -1.0 : 1.0;
`;

export const occlusionParameters = /* glsl */ `
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

export const fabricFragmentParameters = /* glsl */ `
${occlusionParameters}
uniform vec2 threads;
uniform float pattern;
uniform float hemmed;
uniform float coloured;
uniform float fieldPower;
uniform float fieldScale;
uniform vec3 fieldColors[9];
varying float vField;
varying vec2 vCloth;
varying vec3 vWorld;

// Plain weave: threads go over and under in turn. It fades to its mean if a thread is smaller than a pixel.
float weave(vec2 at) {
  vec2 cell = floor(at);
  vec2 q = fract(at) - 0.5;
  bool weftOnTop = mod(cell.x + cell.y, 2.0) < 0.5;
  float across = weftOnTop ? q.y : q.x;
  float along = weftOnTop ? q.x : q.y;
  float height = cos(3.14159 * across * 0.94) * (0.72 + 0.28 * cos(3.14159 * along));
  float shade = (weftOnTop ? 1.0 : 0.95) * (0.7 + 0.42 * height);
  vec2 width = fwidth(at);
  return mix(shade, 0.95, smoothstep(0.3, 0.85, max(width.x, width.y)));
}

// 1 in half of each period and 0 in the other, averaged over a pixel: exactly, by the integral of it.
vec2 halvesUpTo(vec2 periods) {
  vec2 within = fract(periods);
  return 0.5 * floor(periods) + min(within, 0.25) + max(within - 0.75, 0.0);
}
vec2 halves(vec2 periods) {
  vec2 pixel = max(fwidth(periods), 1e-5);
  return (halvesUpTo(periods + 0.5 * pixel) - halvesUpTo(periods - 0.5 * pixel)) / pixel;
}

// How much of the dyed colour is here: 1 all of it, 0 the pale second shade.
float dye(vec2 side) {
  if (pattern < 1.5) return 1.0;
  if (pattern > 2.5) return halves(side * 6.0).x;
  vec2 squares = halves(side * 4.0);
  return mix(squares.x, 1.0 - squares.x, squares.y);
}

vec3 fabricColor(vec3 base, bool front) {
  float longer = max(threads.x, threads.y);
  vec3 pale = mix(base, vec3(0.93, 0.9, 0.84), 0.78);
  vec3 color = mix(pale, base, dye(vCloth / longer));
  color *= pattern < 0.5 ? mix(weave(vCloth * 1.5), 0.95, 0.75) : weave(vCloth);
  vec2 uv = vCloth / threads;
  vec2 inset = min(uv, 1.0 - uv) * threads / longer;
  float border = min(inset.x, inset.y);
  float edge = max(0.0015, 0.75 * fwidth(border));  // no narrower than a pixel
  color *= 1.0 - hemmed * 0.16 * (1.0 - smoothstep(0.0175 - edge, 0.0175 + edge, border));
  return front ? color : mix(color, vec3(dot(color, vec3(0.3, 0.6, 0.1))), 0.25) * 0.94;
}

// Mixed in sRGB, as the legend's gradient is.
vec3 fieldColor() {
  float at = pow(clamp(vField * fieldScale, 0.0, 1.0), fieldPower) * 8.0;
  int below = min(int(at), 7);
  return pow(mix(fieldColors[below], fieldColors[below + 1], at - float(below)), vec3(2.2));
}
`;

/// Grazing light that loose fibres catch, and a little light through the cloth from behind.
export const fabricSheen = /* glsl */ `
if (coloured > 0.5) {
  outgoingLight = mix(outgoingLight, diffuseColor.rgb, 0.35);  // light and shade must not hide what a colour means
} else {
  vec3 viewDirection = normalize(vViewPosition);
  float grazing = 1.0 - saturate(dot(viewDirection, normal));
  grazing *= grazing * grazing;
  outgoingLight += 0.016 + 0.05 * diffuseColor.rgb;  // fibres scatter some of the room's white light
  #if NUM_DIR_LIGHTS > 0
    float towardsLight = dot(normal, directionalLights[0].direction);
    outgoingLight += diffuseColor.rgb * directionalLights[0].color * 0.05 * max(-towardsLight, 0.0);
    outgoingLight += (0.25 + 0.75 * diffuseColor.rgb) * grazing * (0.16 + 0.22 * saturate(0.5 + 0.5 * towardsLight));
  #endif
}
`;

/// A glazed sphere: a soft highlight of the key light and a brighter rim.
export const porcelain = /* glsl */ `
vec3 viewDirection = normalize(vViewPosition);
float rim = pow(1.0 - saturate(dot(viewDirection, normal)), 4.0);
outgoingLight += vec3(0.22) * rim;
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
