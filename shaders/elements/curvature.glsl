// The curvature of one triangle of a sheet that is flat at rest, for XPBD: the same energy as bending.glsl, triangle by
// triangle. It is 1/2 sum |row_a|^2 over three linear forms of the places of (at most) twelve vertices, as
// server/model/plate.h makes them. In the common subset of GLSL and C++ (see types.glsl, elements.h).

struct Curvature {
  real row[36];  // row_a = sum over k of row[12 a + k] x_k [sqrt(N/m)]; each row adds up to 0
  real damping;  // time by which the moment runs ahead of the curvature [s]
};

struct CurvatureEdges {
  vec3 d[11];  // the first corner's value less each other's
};

/// One visit of a sweep of XPBD (Macklin, Mueller & Chentanez 2016, equation 18), a row after the other. `mobility`
/// [1/kg] of the corners; `pushed.d[a]`: the force along row a, times dt^2, that has acted in the step so far. Returns
/// what the first corner gets and each other corner gives [kg m].
FUNCTION CurvatureEdges element_visit(Curvature c, ConstraintGains gains, real mobility[12], CurvatureEdges place,
                                      CurvatureEdges moved, INOUT(CurvatureEdges) pushed) {
  CurvatureEdges push;
  for (int k = 0; k < 11; ++k) push.d[k] = vec3(real(0.0));
  real damped = gains.damping * c.damping, stiff = gains.stretch + damped;
  for (int a = 0; a < 3; ++a) {
    vec3 bent = vec3(real(0.0)), more = vec3(real(0.0));
    real felt = mobility[0] * c.row[12 * a] * c.row[12 * a];
    for (int k = 0; k < 11; ++k) {
      real share = c.row[12 * a + k + 1];
      bent -= share * place.d[k];
      more -= share * moved.d[k];
      felt += mobility[k + 1] * share * share;
    }
    vec3 change = (-gains.stretch * bent - damped * more - pushed.d[a]) * (real(1.0) / (real(1.0) + stiff * felt));
    pushed.d[a] += change;
    vec3 first = mobility[0] * c.row[12 * a] * change;
    for (int k = 0; k < 11; ++k) {
      real share = c.row[12 * a + k + 1];
      vec3 apart = first - mobility[k + 1] * share * change;
      push.d[k] -= share * change;
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
#define Curvature_OF(NUMBER) Curvature(real[36](ROW_OF(NUMBER, 0), ROW_OF(NUMBER, 12), ROW_OF(NUMBER, 24)), NUMBER(36))
#endif
