// GLSL of the cloth's surface: threads at true scale, dyed patterns, the hem's seam, and the colours of a field.

export const weaveParameters = /* glsl */ `
uniform vec2 pitch;         // from a thread to the next [m]
uniform float relief;
uniform vec3 slub;          // share, width of streaks across and along [m]
uniform vec2 size;          // of the cloth in its texture [m]
uniform float backness;
uniform float pattern;
uniform float hemmed;
uniform float coloured;
uniform float fieldPower;
uniform float fieldScale;
uniform vec3 fieldColors[9];
varying float vField;
varying vec2 vCloth;        // place in the texture [m]
varying vec3 vWorld;
varying vec2 vShade;        // share of the light that the cloth keeps from its front and back

const float pi = 3.14159265;

// One place of the weave: how the surface leans along both axes of the texture, how deep it lies, 1 where warp is on
// top.
struct Thread { vec2 slope; float height; float warp; };

// 1 below one third of a pixel to a thread, 0 where threads are smaller than pixels: nothing is left to flicker.
float seen(vec2 at) {
  vec2 width = fwidth(at);
  return 1.0 - smoothstep(0.3, 0.85, max(width.x, width.y));
}

#if WEAVE < 3  // the place in weaves of fabric_looks.ts
Thread threadsOf(vec2 at) {
  vec2 cell = floor(at), q = fract(at) - 0.5;
  #if WEAVE == 0
    float warp = mod(cell.x + cell.y, 2.0);
  #elif WEAVE == 1  // over three, under one, a step aside in each row
    float warp = step(0.5, mod(cell.x + cell.y, 4.0));
  #else  // over four, under one
    float warp = step(0.5, mod(2.0 * cell.x + cell.y, 5.0));
  #endif
  vec2 ways = warp > 0.5 ? q : q.yx;  // along the thread on top, across it
  vec2 slope = vec2(0.0, -sin(pi * 0.94 * ways.y));
  float height = cos(pi * 0.94 * ways.y);
  #if WEAVE == 0
    slope.x = -0.4 * sin(pi * ways.x);
    height *= 0.72 + 0.28 * cos(pi * ways.x);
  #endif
  return Thread(warp > 0.5 ? slope : slope.yx, height, warp);
}
#else  // stitches: columns of V
Thread threadsOf(vec2 at) {
  float side = fract(at.x) - 0.5;
  float leg = 2.0 * abs(side);
  float around = fract(at.y - 0.6 * leg);
  float height = sin(pi * leg) * (0.55 + 0.45 * sin(pi * around));
  return Thread(vec2(sign(side) * cos(pi * leg), -0.6 * cos(pi * around)), height, 1.0);
}
#endif

Thread threadAt(vec2 at, float share) {
  Thread thread = threadsOf(at);
  thread.slope *= share;
  thread.height = mix(0.62, thread.height, share);
  #if WEAVE == 4  // ribs of six stitches
    float rib = at.x / 6.0;
    float ribs = seen(vec2(rib, 0.0));
    thread.slope.x -= 1.1 * ribs * sin(2.0 * pi * rib);
    thread.height += 0.3 * ribs * (cos(2.0 * pi * rib) - 0.2);
  #endif
  return thread;
}

float hash(vec2 p) {
  p = fract(p * vec2(0.1031, 0.1373));
  p += dot(p, p.yx + 33.33);
  return fract((p.x + p.y) * p.x);
}
float noise(vec2 p) {
  vec2 cell = floor(p), q = fract(p);
  q = q * q * (3.0 - 2.0 * q);
  return mix(mix(hash(cell), hash(cell + vec2(1, 0)), q.x), mix(hash(cell + vec2(0, 1)), hash(cell + vec2(1, 1)), q.x), q.y);
}

// Uneven threads: streaks along the warp, around 0.
float unevenness() {
  vec2 along = vCloth / slub.zy;
  return slub.x * seen(along) * (noise(along) - 0.5);
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
float dye() {
  if (pattern < 1.5) return 1.0;
  vec2 side = vCloth / max(size.x, size.y);
  if (pattern > 2.5) return halves(side * 6.0).x;
  vec2 squares = halves(side * 4.0);
  return mix(squares.x, 1.0 - squares.x, squares.y);
}

// The share of a pixel that a line covers, "off" away from its middle.
float line(float off, float width, float pixel) {
  return clamp((0.5 * width + 0.5 * pixel - abs(off)) / pixel, 0.0, 1.0) * min(1.0, width / pixel);
}

// The hem: its fold is a little darker, and stitches hold it.
vec3 withHem(vec3 color) {
  float wide = min(0.012, 0.05 * min(size.x, size.y));
  vec2 inset = min(vCloth, size - vCloth);
  float border = min(inset.x, inset.y);
  float pixel = max(fwidth(border), 1e-6);
  float fold = line(border - wide, 0.09 * wide, pixel);
  float along = (inset.x < inset.y ? vCloth.y : vCloth.x) / (0.36 * wide);
  float stitches = mix(halves(vec2(along)).x, 0.5, smoothstep(0.3, 0.9, fwidth(along)));
  color *= 1.0 - hemmed * (0.45 * fold + 0.06 * (1.0 - smoothstep(wide - pixel, wide + pixel, border)));
  vec3 yarn = WEAVE == 1 && backness > 0.5 ? vec3(0.55, 0.3, 0.08) : color * 1.35 + 0.03;
  return mix(color, yarn, hemmed * 0.8 * stitches * line(border - 0.8 * wide, 0.08 * wide, pixel));
}

vec3 fabricColor(vec3 base, bool front, Thread thread, float share) {
  vec3 pale = vec3(0.86, 0.83, 0.76);
  vec3 color = mix(mix(base, pale, 0.8), base, dye());
  #if WEAVE == 1  // the weft of denim is not dyed
    float undyed = front ? mix(0.04, 0.2 * (1.0 - thread.warp), share) : mix(0.62, mix(0.8, 0.1, thread.warp), 0.7 * share);
    color = mix(color, pale, undyed * backness);
  #else
    if (!front) color = mix(color, mix(vec3(dot(color, vec3(0.3, 0.6, 0.1))), pale, 0.3), 0.45 * backness);
  #endif
  color *= 0.72 + 0.45 * thread.height;
  #ifdef DETAILS
    color = withHem(color * (1.0 + unevenness()));
  #endif
  return color;
}

// Mixed in sRGB, as the legend's gradient is.
vec3 fieldColor() {
  float at = pow(clamp(vField * fieldScale, 0.0, 1.0), fieldPower) * 8.0;
  int below = min(int(at), 7);
  return pow(mix(fieldColors[below], fieldColors[below + 1], at - float(below)), vec3(2.2));
}
`;
