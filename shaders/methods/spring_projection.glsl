// PBD (Mueller et al. 2007, section 3.3) and XPBD (Macklin et al. 2016, equations 17, 18 and 26): a visit to a spring moves its
// two ends, each by its inverse mass. XPBD remembers what a spring has pushed in this step.
READ_UVEC4(projected, 10);   // (vertex a, vertex b, rest length [m], stretch gain [kg]), colour after colour
READ_UVEC2(gains, 11);       // (damping gain [kg], memory)
#ifdef MEMORY
layout(std430, binding = 4) buffer Multipliers { float multipliers[]; };  // [kg m]
#endif

vec3 first_displacement(int i, vec3 v) { return free_displacement(v); }

void visit(int item) {
  uvec4 s = FETCH(projected, item);
  vec2 gain = uintBitsToFloat(FETCH_UVEC2(gains, item));
  vec4 x = FETCH(position, s.x), y = FETCH(position, s.y), dx = displacement(s.x), dy = displacement(s.y);
  vec3 moved = dx.xyz - dy.xyz, n;
  float multiplier = 0.0;
#ifdef MEMORY
  if (sweep > 0) multiplier = multipliers[item];
#endif
  float change = spring_projection((x.xyz - y.xyz) + moved, moved, uintBitsToFloat(s.z), uintBitsToFloat(s.w),
                                   gain.x, gain.y, multiplier, n);
#ifdef MEMORY
  multipliers[item] = multiplier + change;
#endif
  displace(s.x, dx.xyz + (x.w * mobility * change) * n);
  displace(s.y, dy.xyz - (y.w * mobility * change) * n);
}
