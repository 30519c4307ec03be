// PBD (Mueller et al. 2007, section 3.3) and XPBD (Macklin et al. 2016, equations 17, 18 and 26): a visit to a spring
// moves its two ends, each by its inverse mass. XPBD remembers what a spring has pushed in this step.
READ_UVEC4(projected, unit_projected);  // (vertex a, vertex b, rest length [m], stretch gain [kg]), colour after colour
READ_UVEC2(gains, unit_gains);          // (damping gain [kg], memory)
#ifdef MEMORY
layout(std430, binding = slot_pushed) buffer Pushed { vec4 pushed[]; };  // by each spring since the step's start [kg m]
#endif

vec3 first_deviation(int i, vec3 x, vec3 v) { return vec3(0.0); }

void visit(int item) {
  uvec4 s = FETCH(projected, item);
  vec2 gain = uintBitsToFloat(FETCH_UVEC2(gains, item));
  vec4 x = FETCH(position, s.x), y = FETCH(position, s.y);
  vec3 dx = deviation(s.x).xyz, dy = deviation(s.y).xyz;
  vec3 moved = drift(FETCH(velocity, s.x).xyz - FETCH(velocity, s.y).xyz) + (dx - dy);
  float w_x = x.w * mobility, w_y = y.w * mobility;
  SpringGains spring = SpringGains(uintBitsToFloat(s.w), gain.x, gain.y, 0.0);
  vec3 before = vec3(0.0);
#ifdef MEMORY
  if (sweep > 0) before = pushed[item].xyz;
  spring.turning = (w_x + w_y) * spring.stretch / spring.memory;
#endif
  vec3 change = element_projection(uintBitsToFloat(s.z), spring, SpringEdges((x.xyz - y.xyz) + moved),
                                   SpringEdges(moved), SpringEdges(before))
                    .d;
#ifdef MEMORY
  if (sweep < last_sweep) pushed[item].xyz = before + change;
#endif
  set_deviation(s.x, dx + w_x * change);
  set_deviation(s.y, dy - w_y * change);
}
