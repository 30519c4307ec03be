// The bending of a sheet that is flat at rest, as pairs of vertices. Its energy B/2 (curvature)^2 is quadratic in the
// places of the vertices while the sheet keeps its lengths: 1/2 sum of q_ij x_i.x_j, with rows of q that add up to 0
// (Bergou, Wardetzky, Harmon, Zorin & Grinspun 2006). So it is a sum over pairs of k/2 |x_i - x_j|^2 with k = -q_ij, of
// either sign: only the sum over all pairs is positive. server/model/plate.h makes the pairs.
// In the common subset of GLSL and C++ (see types.glsl, elements.h); spring.glsl says what a law is.

struct Bending {
  real stiffness;  // [N/m], of either sign
  real damping;    // time by which the force runs ahead of the bending [s]
};

struct BendingEdges {
  vec3 d[1];  // this corner's value less the other's
};

FUNCTION Bending seen_from(Bending b, int UNUSED(corner)) { return b; }

/// Force [N] on the corner.
FUNCTION vec3 element_force(Bending b, BendingEdges place, BendingEdges velocity) {
  return -b.stiffness * (place.d[0] + b.damping * velocity.d[0]);
}

/// Elastic energy [J]: its sum over all pairs at a vertex means something, a single one does not.
FUNCTION real element_energy(Bending b, BendingEdges place) {
  return real(0.5) * b.stiffness * dot(place.d[0], place.d[0]);
}

FUNCTION real element_stretch(Bending UNUSED(b), BendingEdges UNUSED(place)) { return real(0.0); }
FUNCTION real element_strain(Bending UNUSED(b), BendingEdges UNUSED(place)) { return real(0.0); }

// Sizes of a pair's terms, for bounds and for rounding errors.
FUNCTION real element_size(Bending UNUSED(b)) { return real(0.0); }                         // at rest [m]
FUNCTION real element_stiffness(Bending b) { return max(b.stiffness, -b.stiffness); }       // the largest [N/m]
FUNCTION real element_damping(Bending b) { return b.damping * element_stiffness(b); }       // the largest [N s/m]

/// The terms of the force [N] added up without their signs: rounding errors are a share of it.
FUNCTION real element_force_scale(Bending b, BendingEdges place, BendingEdges velocity) {
  return element_stiffness(b) *
         (sqrt(dot(place.d[0], place.d[0])) + b.damping * sqrt(dot(velocity.d[0], velocity.d[0])));
}

/// Second derivatives: stiffness and damping times the unit matrix, whatever the place.
struct BendingHessian {
  real stiffness, damping;  // [N/m], [N s/m]
};

FUNCTION BendingHessian element_hessian(Bending b, BendingEdges UNUSED(place)) {
  BendingHessian h;
  h.stiffness = b.stiffness;
  h.damping = b.damping * b.stiffness;
  return h;
}

/// The sum over all pairs is definite: nothing is dropped.
FUNCTION BendingHessian element_definite(BendingHessian h) { return h; }
FUNCTION BendingHessian without_rounding(BendingHessian h) { return h; }

/// A matrix that is at least the pair's.
FUNCTION BendingHessian element_bound(BendingHessian h) {
  h.stiffness = max(h.stiffness, real(0.0));
  h.damping = max(h.damping, real(0.0));
  return h;
}

/// A matrix of a pair: this times the unit matrix.
struct BendingMatrix {
  real scale;
};

FUNCTION BendingMatrix stiffness_matrix(BendingHessian h) {
  BendingMatrix m;
  m.scale = h.stiffness;
  return m;
}

FUNCTION BendingMatrix damping_matrix(BendingHessian h) {
  BendingMatrix m;
  m.scale = h.damping;
  return m;
}

/// Matrix dt C + dt^2 K of an implicit step of dt [s] [kg].
FUNCTION BendingMatrix step_matrix(BendingHessian h, real dt) {
  BendingMatrix m;
  m.scale = dt * (dt * h.stiffness + h.damping);
  return m;
}

/// The corner's row of the matrix, times a vector of all corners.
FUNCTION vec3 matrix_product(BendingMatrix m, BendingEdges vector) { return m.scale * vector.d[0]; }

/// Adds the corner's own 3x3 block: its diagonal; there is no off-diagonal.
FUNCTION void add_block(BendingMatrix m, INOUT(vec3) diagonal, INOUT(vec3) UNUSED(off_diagonal)) {
  diagonal += m.scale;
}

/// Ratio of damping to stiffness [s] of any motion that the pairs resist.
FUNCTION real least_damping_time(BendingHessian h) { return h.damping / h.stiffness; }

/// See spring.glsl.
FUNCTION void add_descent(Bending b, real dt, BendingEdges place, BendingEdges moved, INOUT(vec3) residual,
                          INOUT(vec3) diagonal, INOUT(vec3) UNUSED(off_diagonal)) {
  PRECISE real stiffness = b.stiffness * (dt * dt), damping = b.stiffness * b.damping * dt;
  residual -= stiffness * place.d[0] + damping * moved.d[0];
  diagonal += stiffness + damping;
}

/// The pair during a line search, which moves the corners from here in proportion to a share.
struct BendingLine {
  vec3 place, velocity, change;  // [m], [m/s], and the change of velocity in a whole step of the search
};

FUNCTION BendingLine element_line(Bending UNUSED(b), BendingEdges place, BendingEdges velocity, BendingEdges change) {
  BendingLine line;
  line.place = place.d[0];
  line.velocity = velocity.d[0];
  line.change = change.d[0];
  return line;
}

/// Energy and dissipation in a step of dt [J] at this share of the whole step, less those at its start.
FUNCTION real line_energy(Bending b, BendingLine line, real dt, real share) {
  vec3 faster = share * line.change, moved = dt * faster;
  return real(0.5) * b.stiffness *
         (dot(moved, real(2.0) * line.place + moved) +
          dt * b.damping * dot(faster, real(2.0) * line.velocity + faster));
}

#ifndef __cplusplus
#define Bending_OF(NUMBER) Bending(NUMBER(0), NUMBER(1))
#endif
