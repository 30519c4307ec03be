// What a sheet that is curved at rest adds to the pairs of bending.glsl: a vertex that is pulled along the normal of a
// triangle nearby. In the common subset of GLSL and C++ (see types.glsl, elements.h); spring.glsl says what a law is.
//
// The curvature of a triangle is three linear forms r_a of the places around it. At rest each is k_a n, with n the
// triangle's normal, and the energy is 1/2 sum |r_a - k_a n|^2: none in any rigid motion of the rest shape, B/2 (change
// of curvature)^2 near it, and for k = 0 that of a flat sheet (Bergou et al. 2006; with normals Garg, Grinspun,
// Wardetzky & Zorin 2007, Cubic shells). The squares of r_a are pairs. What is left is a constant and -n.(sum k_a r_a),
// in which the triangle's own corners, at height 0, do not count: a sum of -pull * height over the vertices around it.
// Single elements may have any sign; only the sum with the pairs means something.

struct Shell {
  real pull;     // along the normal [N], of either sign
  real energy;   // at height 0 [J]
  real damping;  // time by which the force runs ahead of the place [s]
  real least;    // twice the area [m^2] below which a triangle's normal is no longer made a unit vector
  real corner;   // from which the element is seen: 0, 1, 2 of the triangle, 3 the vertex
};

struct ShellEdges {
  vec3 d[3];  // this corner's value less the others', in cyclic order
};

FUNCTION Shell seen_from(Shell s, int corner) {
  s.corner = real(corner);
  return s;
}

/// A vector of all corners, less its value at one corner of the triangle: at the next two, and at the vertex.
struct Tent {
  vec3 u, v, w;
};

FUNCTION Tent tent(Shell s, ShellEdges vector) {
  Tent t;
  t.u = -vector.d[0];
  t.v = -vector.d[2];
  t.w = -vector.d[1];
  if (s.corner > real(2.5)) {
    t.u = vector.d[0] - vector.d[1];
    t.v = vector.d[0] - vector.d[2];
    t.w = vector.d[0];
  } else if (s.corner > real(1.5)) {
    t.u = -vector.d[1];
    t.w = -vector.d[0];
  } else if (s.corner < real(0.5)) {
    t.v = -vector.d[1];
    t.w = -vector.d[2];
  }
  return t;
}

FUNCTION Tent moved_tent(Tent t, real share, Tent change) {
  t.u += share * change.u;
  t.v += share * change.v;
  t.w += share * change.w;
  return t;
}

/// The vertex over the triangle. A triangle without area has no normal; one that is nearly flattened to a line has a
/// short one, in proportion to its area, so that forces stay bounded.
struct ShellHessian {
  Shell law;
  Tent at;
  vec3 normal;   // of length 1, or less
  vec3 lean;     // change of the height with the cross product of u and v [1/m]
  real height;   // [m]
  real inverse;  // 1 / |u x v|, or what takes its place [1/m^2]
  real unit;     // 1 if the normal has length 1, else 0
  real bound;    // see element_bound; 0 otherwise [N/m]
};

FUNCTION ShellHessian over(Shell s, Tent at) {
  ShellHessian h;
  h.law = s;
  h.at = at;
  vec3 area = cross(at.u, at.v);
  real size = sqrt(dot(area, area));
  h.unit = size > s.least ? real(1.0) : real(0.0);
  h.inverse = real(1.0) / max(max(size, s.least), real(1e-30));
  h.normal = h.inverse * area;
  h.height = dot(h.normal, at.w);
  h.lean = h.inverse * (at.w - h.unit * h.height * h.normal);
  h.bound = real(0.0);
  return h;
}

/// Change of the height as the corner moves.
FUNCTION vec3 rise(ShellHessian h) {
  if (h.law.corner > real(2.5)) return h.normal;
  return cross(h.at.u - h.at.v, h.lean) - h.normal;
}

/// What the height's derivatives are made of, as all corners move.
struct Turning {
  vec3 area, normal, lean;
};

FUNCTION Turning turning(ShellHessian h, Tent moved) {
  Turning t;
  t.area = cross(moved.u, h.at.v) + cross(h.at.u, moved.v);
  real growth = h.unit * dot(h.normal, t.area);
  t.normal = h.inverse * (t.area - growth * h.normal);
  real raised = dot(h.normal, moved.w) + dot(h.lean, t.area);
  t.lean = h.inverse * (moved.w - h.unit * (raised * h.normal + h.height * t.normal) - growth * h.lean);
  return t;
}

/// Change of `rise` as all corners move, to first order.
FUNCTION vec3 rise_change(ShellHessian h, Tent moved) {
  Turning t = turning(h, moved);
  if (h.law.corner > real(2.5)) return t.normal;
  return cross(moved.u - moved.v, h.lean) + cross(h.at.u - h.at.v, t.lean) - t.normal;
}

/// Second derivative of the height along two motions of all corners.
FUNCTION real height_curvature(ShellHessian h, Tent first, Tent second) {
  Turning t = turning(h, first);
  vec3 area = cross(second.u, h.at.v) + cross(h.at.u, second.v);
  return dot(t.normal, second.w) + dot(t.lean, area) +
         dot(h.lean, cross(first.u, second.v) + cross(second.u, first.v));
}

/// Force [N] on the corner.
FUNCTION vec3 element_force(Shell s, ShellEdges place, ShellEdges velocity) {
  ShellHessian h = over(s, tent(s, place));
  return s.pull * (rise(h) + s.damping * rise_change(h, tent(s, velocity)));
}

/// Elastic energy [J]: its sum with that of the pairs means something, a single one does not.
FUNCTION real element_energy(Shell s, ShellEdges place) { return s.energy - s.pull * over(s, tent(s, place)).height; }

FUNCTION real element_stretch(Shell UNUSED(s), ShellEdges UNUSED(place)) { return real(0.0); }
FUNCTION real element_strain(Shell UNUSED(s), ShellEdges UNUSED(place)) { return real(0.0); }

// Sizes of an element's terms, for bounds and for rounding errors.
FUNCTION real element_size(Shell UNUSED(s)) { return real(0.0); }  // at rest [m]
FUNCTION real element_stiffness(Shell s) {                         // the largest [N/m]
  return s.least > real(0.0) ? max(s.pull, -s.pull) / sqrt(s.least) : real(0.0);
}
FUNCTION real element_damping(Shell s) { return s.damping * element_stiffness(s); }  // the largest [N s/m]

/// The terms of the force [N] added up without their signs: rounding errors are a share of it.
FUNCTION real element_force_scale(Shell s, ShellEdges place, ShellEdges velocity) {
  ShellHessian h = over(s, tent(s, place));
  vec3 raised = rise(h), changed = rise_change(h, tent(s, velocity));
  return max(s.pull, -s.pull) * (real(1.0) + sqrt(dot(raised, raised)) + s.damping * sqrt(dot(changed, changed)));
}

FUNCTION ShellHessian element_hessian(Shell s, ShellEdges place) { return over(s, tent(s, place)); }

/// The sum with the pairs is definite at rest, and near it by far less than inertia is: nothing is dropped.
FUNCTION ShellHessian element_definite(ShellHessian h) { return h; }
FUNCTION ShellHessian without_rounding(ShellHessian h) { return h; }

/// A matrix of an element: `scale` times the second derivatives, or times `bound` and the unit matrix.
struct ShellMatrix {
  ShellHessian at;
  real scale;
};

FUNCTION ShellMatrix shell_matrix(ShellHessian h, real scale) {
  ShellMatrix m;
  m.at = h;
  m.scale = scale;
  return m;
}

FUNCTION ShellMatrix stiffness_matrix(ShellHessian h) { return shell_matrix(h, real(1.0)); }
FUNCTION ShellMatrix damping_matrix(ShellHessian h) { return shell_matrix(h, h.law.damping); }

/// Matrix dt C + dt^2 K of an implicit step of dt [s] [kg].
FUNCTION ShellMatrix step_matrix(ShellHessian h, real dt) { return shell_matrix(h, dt * (dt + h.law.damping)); }

/// The corner's row of the matrix, times a vector of all corners.
FUNCTION vec3 matrix_product(ShellMatrix m, ShellEdges vector) {
  if (m.at.bound > real(0.0)) return (m.scale * m.at.bound) * vector.d[0];
  return (-m.scale * m.at.law.pull) * rise_change(m.at, tent(m.at.law, vector));
}

/// A move of one corner along an axis; number 3 is the corner itself, the others follow in cyclic order.
FUNCTION ShellEdges unit_move(int which, int axis) {
  vec3 along = vec3(real(0.0));
  along[axis] = real(1.0);
  ShellEdges move;
  for (int k = 0; k < 3; ++k) move.d[k] = which == 3 ? along : (which == k ? -along : vec3(real(0.0)));
  return move;
}

/// Adds the corner's own 3x3 block: its diagonal, and its off-diagonal (21, 31, 32).
FUNCTION void add_block(ShellMatrix m, INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  vec3 x = matrix_product(m, unit_move(3, 0)), y = matrix_product(m, unit_move(3, 1));
  vec3 z = matrix_product(m, unit_move(3, 2));
  diagonal += vec3(x.x, y.y, z.z);
  off_diagonal += vec3(x.y, x.z, y.z);
}

/// A diagonal matrix that is at least the element's: the sum of the sizes of the blocks in the corner's row
/// (Gershgorin's discs, by blocks).
FUNCTION ShellHessian element_bound(ShellHessian h) {
  real sum = real(0.0);
  for (int which = 0; which < 4; ++which) {
    real squares = real(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      vec3 column = rise_change(h, tent(h.law, unit_move(which, axis)));
      squares += dot(column, column);
    }
    sum += sqrt(squares);
  }
  h.bound = max(h.law.pull, -h.law.pull) * sum;
  return h;
}

/// Ratio of damping to stiffness [s] of any motion that the element resists.
FUNCTION real least_damping_time(ShellHessian h) { return h.law.damping; }

/// See spring.glsl.
FUNCTION void add_descent(Shell s, real dt, ShellEdges place, ShellEdges moved, INOUT(vec3) residual,
                          INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  ShellHessian h = over(s, tent(s, place));
  PRECISE vec3 raised = (dt * dt) * rise(h), damped = (dt * s.damping) * rise_change(h, tent(s, moved));
  residual += s.pull * (raised + damped);
  add_block(step_matrix(h, dt), diagonal, off_diagonal);
}

/// The element during a line search, which moves the corners from here in proportion to a share.
struct ShellLine {
  Tent place, change;  // [m], and the change of velocity in a whole step of the search [m/s]
  real height;         // [m]
  real rate, faster;   // the height's second derivative along velocity and change, and twice along the change
};

/// `change` [m/s]: change of velocity in a whole step of the search; over dt [s] it moves the corners, too.
FUNCTION ShellLine element_line(Shell s, ShellEdges place, ShellEdges velocity, ShellEdges change) {
  ShellLine line;
  line.place = tent(s, place);
  line.change = tent(s, change);
  ShellHessian h = over(s, line.place);
  line.height = h.height;
  line.rate = height_curvature(h, tent(s, velocity), line.change);
  line.faster = height_curvature(h, line.change, line.change);
  return line;
}

/// Energy and dissipation in a step of dt [J] at this share of the whole step, less those at its start.
FUNCTION real line_energy(Shell s, ShellLine line, real dt, real share) {
  real raised = over(s, moved_tent(line.place, dt * share, line.change)).height - line.height;
  real damped = dt * s.damping * share * (line.rate + real(0.5) * share * line.faster);
  return -s.pull * (raised + damped);
}

#ifndef __cplusplus
#define Shell_OF(NUMBER) Shell(NUMBER(0), NUMBER(1), NUMBER(2), NUMBER(3), NUMBER(4))
#endif
