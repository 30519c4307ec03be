// PBD (Mueller et al. 2007, section 3.3) and XPBD (Macklin et al. 2016, equations 17, 18 and 26): a visit to an element
// moves its corners, each by its inverse mass. XPBD remembers what an element has pushed in this step.
#include "../elements/curvature.glsl"
READ_UVEC4(visits, unit_visits);  // law after law, colour after colour: server/sim/coloured_work.h
#ifdef MEMORY
// For each element, and each corner but the first: the first's pushes away from that corner in this step so far [kg m].
layout(std430, binding = slot_pushed) buffer Pushed { vec4 pushed[]; };
#ifdef ONE_GROUP
vec3 pushed_before(int i) { return pushed[i].xyz; }
#else  // the sweep before was another dispatch
READ_VEC4(pushed_read, unit_pushed);
vec3 pushed_before(int i) { return FETCH(pushed_read, i).xyz; }
#endif
#endif

#ifdef WIND
/// The wind acts as in an explicit step: the elements' gains are for the vertices' true masses.
vec3 first_deviation(int i, vec4 x, vec3 v) {
  return drift(dt * wind_acceleration(i, x, v, wind_velocity(END_ROW)));
}
#else
vec3 first_deviation(int i, vec4 x, vec3 v) { return vec3(0.0); }
#endif

#each Law of SWEPT_LAWS
uniform ivec3 first_of_Law;  // item, texel of `visits`, push of `pushed`

/// A visit's layout: all vertices, numbers of the law, then the gains.
struct LawVisit {
  int vertices[Law_CORNERS];
  Law law;
  ConstraintGains gains;
};

LawVisit visit_of_Law(int at) {
  uvec4 texels[Law_VISIT_TEXELS];
  for (int t = 0; t < Law_VISIT_TEXELS; ++t) texels[t] = FETCH(visits, at + t);
  LawVisit visit;
  for (int k = 0; k < Law_CORNERS; ++k) visit.vertices[k] = int(texels[k / 4][k % 4]);
#define WORD(k) uintBitsToFloat(texels[(Law_CORNERS + k) / 4][(Law_CORNERS + k) % 4])
#define NUMBER(k) (k < Law_VISIT_NUMBERS ? WORD(k) : 0.0)
  visit.law = Law_OF(NUMBER);
  visit.gains = ConstraintGains(WORD(Law_VISIT_NUMBERS), WORD(Law_VISIT_NUMBERS + 1), WORD(Law_VISIT_NUMBERS + 2), 0.0);
#undef NUMBER
#undef WORD
  return visit;
}

void visit_Law(int item) {
  int number = item - first_of_Law.x, first_push = first_of_Law.z + number * (Law_CORNERS - 1);
  LawVisit visit = visit_of_Law(first_of_Law.y + number * Law_VISIT_TEXELS);
  vec3 d[Law_CORNERS];
  float w[Law_CORNERS], w_all = 0.0;
  for (int k = 0; k < Law_CORNERS; ++k) {
    d[k] = deviation(visit.vertices[k]).xyz;
    w[k] = FETCH(position, visit.vertices[k]).w * mobility;
    w_all += w[k];
  }
  LawEdges place, moved, before;
  for (int k = 0; k < Law_CORNERS - 1; ++k) {
    int i = visit.vertices[0], j = visit.vertices[k + 1];
    // precise: both forms of the kernel are compiled apart and must round alike.
    precise vec3 way = drift(FETCH(velocity, i).xyz - FETCH(velocity, j).xyz) + (d[0] - d[k + 1]);
    precise vec3 now = (FETCH(position, i).xyz - FETCH(position, j).xyz) + way;
    moved.d[k] = way;
    place.d[k] = now;
    before.d[k] = vec3(0.0);
#ifdef MEMORY
    if (sweep > 0) before.d[k] = pushed_before(first_push + k);
#endif
  }
#ifdef MEMORY
  visit.gains.turning = w_all * visit.gains.stretch / visit.gains.memory;
#endif
  LawEdges push = element_visit(visit.law, visit.gains, w, place, moved, before);
  for (int k = 0; k < Law_CORNERS - 1; ++k) {
#ifdef MEMORY
    if (sweep < last_sweep) pushed[first_push + k].xyz = before.d[k];
#endif
    d[0] += w[0] * push.d[k];
    set_deviation(visit.vertices[k + 1], d[k + 1] - w[k + 1] * push.d[k]);
  }
  set_deviation(visit.vertices[0], d[0]);
}
#end
