// The curvature of one triangle of a sheet, for XPBD: the same energy as bending.glsl and shell.glsl, triangle by
// triangle. It is 1/2 sum |row_a - rest_a n|^2 over three linear forms of the places of (at most) twelve vertices, as
// server/model/plate.h and shell.h make them, with n the triangle's normal.
// In the common subset of GLSL and C++ (see types.glsl, elements.h).

struct Curvature {
  real row[36];  // row_a = sum over k of row[12 a + k] x_k [sqrt(N/m)]; each row adds up to 0; the first three are the
                 // triangle's own corners
  real rest[3];  // row_a at rest, along the normal [sqrt(N m)]; 0 for a sheet that is flat at rest
  real damping;  // time by which the moment runs ahead of the curvature [s]
};

struct CurvatureEdges {
  vec3 d[11];  // the first corner's value less each other's
};

/// A triangle's normal, and how it turns: by -sum of slope_i (n.dx_i) as its corners move. All 0 without an area.
struct TriangleNormal {
  vec3 n;
  vec3 slope[3];  // [1/m]
};

/// u, v: from the first corner to the others.
FUNCTION TriangleNormal triangle_normal(vec3 u, vec3 v) {
  TriangleNormal t;
  vec3 area = cross(u, v);
  real size = sqrt(dot(area, area));
  real inverse = size > real(0.0) ? real(1.0) / size : real(0.0);
  t.n = inverse * area;
  t.slope[1] = inverse * cross(v, t.n);
  t.slope[2] = inverse * cross(t.n, u);
  t.slope[0] = -(t.slope[1] + t.slope[2]);
  return t;
}

/// One visit of a sweep of XPBD (Macklin, Mueller & Chentanez 2016, equation 18), a row after the other. `mobility`
/// [1/kg] of the corners; `pushed.d[a]`: the force along row a, times dt^2, that has acted in the step so far. Returns
/// what the first corner gets and each other corner gives [kg m].
FUNCTION CurvatureEdges element_visit(Curvature c, ConstraintGains gains, real mobility[12], CurvatureEdges place,
                                      CurvatureEdges moved, INOUT(CurvatureEdges) pushed) {
  CurvatureEdges push;
  for (int k = 0; k < 11; ++k) push.d[k] = vec3(real(0.0));
  real damped = gains.damping * c.damping, stiff = gains.stretch + damped;
  for (int a = 0; a < 3; ++a) {
    TriangleNormal t = triangle_normal(-place.d[0], -place.d[1]);
    vec3 turned = dot(t.n, moved.d[0]) * t.slope[1] + dot(t.n, moved.d[1]) * t.slope[2];
    vec3 bent = -c.rest[a] * t.n, more = -c.rest[a] * turned;
    real felt = mobility[0] * c.row[12 * a] * c.row[12 * a];
    for (int k = 0; k < 11; ++k) {
      real share = c.row[12 * a + k + 1];
      bent -= share * place.d[k];
      more -= share * moved.d[k];
      felt += mobility[k + 1] * share * share;
    }
    // What turning the normal adds to the corners' responses; its size is a bound, so that a visit never overshoots.
    for (int k = 0; k < 3; ++k) {
      real own = c.row[12 * a + k], turns = c.rest[a] * sqrt(dot(t.slope[k], t.slope[k]));
      felt += mobility[k] * (turns * turns + real(2.0) * max(own * turns, -own * turns));
    }
    vec3 change = (-gains.stretch * bent - damped * more - pushed.d[a]) * (real(1.0) / (real(1.0) + stiff * felt));
    pushed.d[a] += change;
    vec3 along = c.rest[a] * t.n;
    vec3 first = mobility[0] * c.row[12 * a] * change + mobility[0] * dot(t.slope[0], change) * along;
    for (int k = 0; k < 11; ++k) {
      real share = c.row[12 * a + k + 1];
      vec3 turning = k < 2 ? dot(t.slope[min(k + 1, 2)], change) * along : vec3(real(0.0));
      vec3 apart = first - mobility[k + 1] * share * change - mobility[k + 1] * turning;
      push.d[k] -= share * change + turning;
      place.d[k] += apart;
      moved.d[k] += apart;
    }
  }
  return push;
}

#ifndef __cplusplus
#define ROW_OF(NUMBER, a)                                                                                    \
  NUMBER(a + 0), NUMBER(a + 1), NUMBER(a + 2), NUMBER(a + 3), NUMBER(a + 4), NUMBER(a + 5), NUMBER(a + 6), \
      NUMBER(a + 7), NUMBER(a + 8), NUMBER(a + 9), NUMBER(a + 10), NUMBER(a + 11)
#define Curvature_OF(NUMBER)                                                                       \
  Curvature(real[36](ROW_OF(NUMBER, 0), ROW_OF(NUMBER, 12), ROW_OF(NUMBER, 24)),                   \
            real[3](NUMBER(36), NUMBER(37), NUMBER(38)), NUMBER(39))
#endif
