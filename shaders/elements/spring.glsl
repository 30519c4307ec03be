// A damped spring between two vertices: Hooke's law, and damping along the spring only.
// Provot 1995, section 2. In the common subset of GLSL and C++ (see types.glsl, elements.h).
//
// Like every law it sees an element from one of its corners: `Edges` are the differences between that corner and the
// others, of places [m], of velocities [m/s], or of any other vector at vertices. All laws define the functions
// below under the same names (shaders/README.md).

struct Spring {
  real rest_length;  // [m]
  real stiffness;    // [N/m]
  real damping;      // [N s/m]
};

struct SpringEdges {
  vec3 d[1];  // this corner's value less the other's
};

/// The law's numbers as the element's corner number `corner` sees them: the same from both ends of a spring.
FUNCTION Spring seen_from(Spring s, int UNUSED(corner)) { return s; }

/// Force [N] on the corner. A spring of length 0 has no direction and gives no force. Damping acts on the relative
/// velocity projected on the spring: it does not act on a rigid rotation.
FUNCTION vec3 element_force(Spring s, SpringEdges place, SpringEdges velocity) {
  real length_squared = dot(place.d[0], place.d[0]);
  real inverse_length = length_squared > real(0.0) ? real(1.0) / sqrt(length_squared) : real(0.0);
  vec3 n = place.d[0] * inverse_length;
  real length_now = length_squared * inverse_length;
  real tension = s.stiffness * (length_now - s.rest_length) + s.damping * dot(n, velocity.d[0]);
  return n * (-tension);
}

/// Elastic energy [J] of the spring.
FUNCTION real element_energy(Spring s, SpringEdges place) {
  real stretch = sqrt(dot(place.d[0], place.d[0])) - s.rest_length;
  return real(0.5) * s.stiffness * stretch * stretch;
}

/// Stretch l/L - 1; 0 for a spring without rest length.
FUNCTION real element_stretch(Spring s, SpringEdges place) {
  real stretch = sqrt(dot(place.d[0], place.d[0])) - s.rest_length;
  return s.rest_length > real(0.0) ? stretch / s.rest_length : real(0.0);
}

/// Strain |l/L - 1|.
FUNCTION real element_strain(Spring s, SpringEdges place) {
  real stretch = element_stretch(s, place);
  return max(stretch, -stretch);
}

// Sizes of a spring's terms, for bounds and for rounding errors.
FUNCTION real element_size(Spring s) { return s.rest_length; }     // [m]
FUNCTION real element_stiffness(Spring s) { return s.stiffness; }  // the largest [N/m]
FUNCTION real element_damping(Spring s) { return s.damping; }      // the largest [N s/m]

/// The terms of the force [N] added up without their signs: rounding errors are a share of it.
FUNCTION real element_force_scale(Spring s, SpringEdges place, SpringEdges velocity) {
  return s.stiffness * (sqrt(dot(place.d[0], place.d[0])) + s.rest_length) +
         s.damping * sqrt(dot(velocity.d[0], velocity.d[0]));
}

/// Second derivatives of energy and dissipation with respect to the corner's place and velocity, -df/dx [N/m] and
/// -df/dv [N s/m]: along n n^T + across (I - n n^T), and damping n n^T, with n the spring's direction. `across` is
/// negative in a compressed spring: that part makes the matrix indefinite, and implicit methods drop it (Choi & Ko
/// 2002, section 4). A spring of length 0 gives stiffness times the unit matrix.
struct SpringHessian {
  vec3 n;
  real along, across, damping;
};

FUNCTION SpringHessian element_hessian(Spring s, SpringEdges place) {
  real length_squared = dot(place.d[0], place.d[0]);
  real inverse_length = length_squared > real(0.0) ? real(1.0) / sqrt(length_squared) : real(0.0);
  SpringHessian h;
  h.n = place.d[0] * inverse_length;
  h.along = s.stiffness;
  h.across = s.stiffness * (real(1.0) - s.rest_length * inverse_length);
  h.damping = s.damping;
  return h;
}

/// The Hessian without the part that makes it indefinite.
FUNCTION SpringHessian element_definite(SpringHessian h) {
  h.across = max(h.across, real(0.0));
  return h;
}

/// The Hessian without the `across` that rounding of a rest shape leaves: that is no tension.
FUNCTION SpringHessian without_rounding(SpringHessian h) {
  if (h.across < real(1e-9) * h.along) h.across = real(0.0);
  return h;
}

/// A matrix that is at least the element's: a definite one's is itself.
FUNCTION SpringHessian element_bound(SpringHessian h) { return h; }

/// A matrix of a spring: along n n^T + across (I - n n^T).
struct SpringMatrix {
  vec3 n;
  real along, across;
};

FUNCTION SpringMatrix stiffness_matrix(SpringHessian h) {
  SpringMatrix m;
  m.n = h.n;
  m.along = h.along;
  m.across = h.across;
  return m;
}

FUNCTION SpringMatrix damping_matrix(SpringHessian h) {
  SpringMatrix m;
  m.n = h.n;
  m.along = h.damping;
  m.across = real(0.0);
  return m;
}

/// Matrix dt C + dt^2 K of an implicit step of dt [s], without the part that makes it indefinite [kg].
FUNCTION SpringMatrix step_matrix(SpringHessian h, real dt) {
  SpringMatrix m;
  m.n = h.n;
  m.along = dt * (dt * h.along + h.damping);
  m.across = dt * dt * max(h.across, real(0.0));
  return m;
}

/// The corner's row of the matrix, times a vector of all corners.
FUNCTION vec3 matrix_product(SpringMatrix m, SpringEdges vector) {
  return m.across * vector.d[0] + m.n * ((m.along - m.across) * dot(m.n, vector.d[0]));
}

/// Adds the corner's own 3x3 block: its diagonal, and its off-diagonal (21, 31, 32).
FUNCTION void add_block(SpringMatrix m, INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  real more = m.along - m.across;
  diagonal += m.across + more * m.n * m.n;
  off_diagonal += vec3(more * m.n.x * m.n.y, more * m.n.x * m.n.z, more * m.n.y * m.n.z);
}

/// Smallest ratio of damping to stiffness [s] of any motion that the spring resists.
FUNCTION real least_damping_time(SpringHessian h) {
  return h.across > real(0.0) ? real(0.0) : h.damping / h.along;
}

/// Adds what VBD needs at a corner, for a step of dt [s] in which the corners have moved by `moved` [m] so far: dt^2
/// times the force [kg m] to the residual, dt C + dt^2 K to the corner's block. The length is measured along the
/// direction, and nothing is left to the compiler's order: both forms of the kernel must round alike.
FUNCTION void add_descent(Spring s, real dt, SpringEdges place, SpringEdges moved, INOUT(vec3) residual,
                          INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  SpringHessian h = element_definite(element_hessian(s, place));
  real along = h.along * (dt * dt), across = dt * dt * h.across, damping = dt * h.damping;
  residual -= (along * (dot(h.n, place.d[0]) - s.rest_length) + damping * dot(h.n, moved.d[0])) * h.n;
  PRECISE real more = along + damping - across;
  diagonal += across + more * h.n * h.n;
  off_diagonal += vec3(more * h.n.x * h.n.y, more * h.n.x * h.n.z, more * h.n.y * h.n.z);
}

/// The spring during a line search, which moves the corners from here in proportion to a share.
struct SpringLine {
  vec3 place, change;           // [m], and its change in a whole step of the search
  real length_before;           // [m]
  real closing, closing_change;  // speed along the spring [m/s], and its change in a whole step of the search
};

/// `change` [m/s]: change of velocity in a whole step of the search; over dt [s] it moves the corners, too.
FUNCTION SpringLine element_line(Spring UNUSED(s), SpringEdges place, SpringEdges velocity, SpringEdges change) {
  SpringLine line;
  line.place = place.d[0];
  line.change = change.d[0];
  line.length_before = sqrt(dot(place.d[0], place.d[0]));
  vec3 n = line.length_before > real(0.0) ? place.d[0] / line.length_before : vec3(real(0.0));
  line.closing = dot(n, velocity.d[0]);
  line.closing_change = dot(n, change.d[0]);
  return line;
}

/// Energy and dissipation in a step of dt [J] at this share of the whole step, less those at its start.
FUNCTION real line_energy(Spring s, SpringLine line, real dt, real share) {
  vec3 there = line.place + (dt * share) * line.change;
  real now = sqrt(dot(there, there)), more = share * line.closing_change;
  real before = line.length_before;
  return real(0.5) * (s.stiffness * (now - before) * (now + before - real(2.0) * s.rest_length) +
                      dt * s.damping * more * (real(2.0) * line.closing + more));
}

/// One visit of a sweep, in PBD and XPBD (Mueller et al. 2007, section 3.3; Macklin et al. 2016, equations 18 and 26):
/// the impulse times dt [kg m] that the spring adds to its first end and takes from its second. `place`: difference of
/// its ends now, `moved`: its change since the step's start, `pushed`: impulses given since then. Earlier impulses are
/// turned to the spring's present direction; published XPBD leaves their direction, and so misses implicit Euler's
/// solution when springs turn within a step. `turning` accounts for the spring's own resistance (Newton's method, if it
/// is stretched).
FUNCTION SpringEdges element_projection(Spring s, ConstraintGains gains, SpringEdges place, SpringEdges moved,
                                        SpringEdges pushed) {
  SpringEdges push;
  push.d[0] = vec3(real(0.0));
  real length_squared = dot(place.d[0], place.d[0]);
  if (!(length_squared > real(0.0))) return push;
  real inverse_length = real(1.0) / sqrt(length_squared);
  vec3 n = place.d[0] * inverse_length;
  real stretch = length_squared * inverse_length - s.rest_length;
  real along = dot(n, pushed.d[0]);
  real change = -(gains.stretch * stretch + gains.damping * dot(n, moved.d[0]) + gains.memory * along);
  real resisted = gains.turning * inverse_length * max(stretch, -stretch);
  push.d[0] = n * change - (pushed.d[0] - n * along) * (real(1.0) / (real(1.0) + resisted));
  return push;
}

/// The same, with what it remembers. `mobility`: of the ends; a spring's gains know them.
FUNCTION SpringEdges element_visit(Spring s, ConstraintGains gains, real UNUSED(mobility)[2], SpringEdges place,
                                   SpringEdges moved, INOUT(SpringEdges) pushed) {
  SpringEdges push = element_projection(s, gains, place, moved, pushed);
  pushed.d[0] += push.d[0];
  return push;
}

#ifndef __cplusplus
/// NUMBER(k): macro for the law's number k, in the order of its members.
#define Spring_OF(NUMBER) Spring(NUMBER(0), NUMBER(1), NUMBER(2))
#endif
