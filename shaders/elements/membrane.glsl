// A triangle of a sheet that resists being stretched and sheared: an orthotropic St. Venant-Kirchhoff membrane (Bonet &
// Wood 2008, sections 4.5 and 6.4; for cloth Volino, Magnenat-Thalmann & Faure 2009), damped in proportion to its
// stiffness. In the common subset of GLSL and C++ (see types.glsl, elements.h); spring.glsl says what a law is.
//
// F = [f0, f1] are the images of the unit vectors along warp and weft at rest. The Green strain is
// E = ((|f0|^2 - 1)/2, (|f1|^2 - 1)/2, f0.f1), the energy area/2 E.K E with
// K = [[warp, coupling, 0], [coupling, weft, 0], [0, 0, shear]]. Compressed to less than 0.58 of its length it yields:
// a sheet buckles long before.

struct Membrane {
  // Share of the first and of the second other corner in F [1/m]:
  // F = -(d[0] (first_warp, first_weft)^T + d[1] (second_warp, second_weft)^T).
  real first_warp, first_weft, second_warp, second_weft;
  real warp, weft, coupling, shear;  // area times K [N m]
  real damping;                      // time by which the stress runs ahead of the strain [s]
};

struct MembraneEdges {
  vec3 d[2];  // this corner's value less the next one's, and less the one's after that
};

/// The corners' shares in F add up to 0.
FUNCTION Membrane seen_from(Membrane m, int corner) {
  real third_warp = -(m.first_warp + m.second_warp), third_weft = -(m.first_weft + m.second_weft);
  Membrane seen = m;
  if (corner == 1) {
    seen.first_warp = m.second_warp;
    seen.first_weft = m.second_weft;
    seen.second_warp = third_warp;
    seen.second_weft = third_weft;
  }
  if (corner == 2) {
    seen.first_warp = third_warp;
    seen.first_weft = third_weft;
    seen.second_warp = m.first_warp;
    seen.second_weft = m.first_weft;
  }
  return seen;
}

/// Derivatives along warp and weft of a vector that is linear over the triangle.
struct Gradient {
  vec3 warp, weft;
};

FUNCTION Gradient gradient(Membrane m, MembraneEdges vector) {
  Gradient g;
  g.warp = -(m.first_warp * vector.d[0] + m.second_warp * vector.d[1]);
  g.weft = -(m.first_weft * vector.d[0] + m.second_weft * vector.d[1]);
  return g;
}

/// Green strain: along warp, along weft, shear (twice the tensor's off-diagonal).
FUNCTION vec3 green_strain(Gradient f) {
  return vec3(real(0.5) * (dot(f.warp, f.warp) - real(1.0)), real(0.5) * (dot(f.weft, f.weft) - real(1.0)),
              dot(f.warp, f.weft));
}

/// Change of the Green strain with a change of the gradient, to first order.
FUNCTION vec3 strain_change(Gradient f, Gradient change) {
  return vec3(dot(f.warp, change.warp), dot(f.weft, change.weft), dot(f.warp, change.weft) + dot(f.weft, change.warp));
}

/// Area times K times a strain [N m].
FUNCTION vec3 membrane_stress(Membrane m, vec3 strain) {
  return vec3(m.warp * strain.x + m.coupling * strain.y, m.coupling * strain.x + m.weft * strain.y, m.shear * strain.z);
}

/// The stress's pull on the corner along a gradient: the product of the strain's derivative by the corner's place,
/// transposed, with the stress. `stress`: along warp, along weft, shear.
FUNCTION vec3 pull(Membrane m, Gradient f, vec3 stress) {
  real warp = m.first_warp + m.second_warp, weft = m.first_weft + m.second_weft;  // less the corner's own share in F
  return (stress.x * warp + stress.z * weft) * f.warp + (stress.y * weft + stress.z * warp) * f.weft;
}

/// Force [N] on the corner. A rigid motion changes no strain, so it is neither resisted nor damped.
FUNCTION vec3 element_force(Membrane m, MembraneEdges place, MembraneEdges velocity) {
  Gradient f = gradient(m, place);
  vec3 strain = green_strain(f) + m.damping * strain_change(f, gradient(m, velocity));
  return pull(m, f, membrane_stress(m, strain));
}

/// Elastic energy [J] of the triangle.
FUNCTION real element_energy(Membrane m, MembraneEdges place) {
  vec3 strain = green_strain(gradient(m, place));
  return real(0.5) * dot(strain, membrane_stress(m, strain));
}

/// The largest stretch along warp or weft: length over rest length, less 1.
FUNCTION real element_stretch(Membrane m, MembraneEdges place) {
  Gradient f = gradient(m, place);
  return sqrt(max(dot(f.warp, f.warp), dot(f.weft, f.weft))) - real(1.0);
}

/// The largest change of length along warp or weft, as a share of the rest length; 0 without a material.
FUNCTION real element_strain(Membrane m, MembraneEdges place) {
  if (!(m.warp > real(0.0))) return real(0.0);
  Gradient f = gradient(m, place);
  real warp = sqrt(dot(f.warp, f.warp)) - real(1.0), weft = sqrt(dot(f.weft, f.weft)) - real(1.0);
  return max(max(warp, -warp), max(weft, -weft));
}

/// Squared length of the largest corner's share in F [1/m^2].
FUNCTION real largest_share_squared(Membrane m) {
  real first = m.first_warp * m.first_warp + m.first_weft * m.first_weft;
  real second = m.second_warp * m.second_warp + m.second_weft * m.second_weft;
  real warp = m.first_warp + m.second_warp, weft = m.first_weft + m.second_weft;
  return max(max(first, second), warp * warp + weft * weft);
}

// Sizes of a triangle's terms, for bounds and for rounding errors.
FUNCTION real element_size(Membrane m) { return real(1.0) / sqrt(largest_share_squared(m)); }  // the least height [m]
FUNCTION real element_stiffness(Membrane m) {  // the largest [N/m]
  return (max(m.warp, m.weft) + m.shear) * largest_share_squared(m);
}
FUNCTION real element_damping(Membrane m) { return m.damping * element_stiffness(m); }  // the largest [N s/m]

/// The terms of the force [N] added up without their signs: rounding errors are a share of it.
FUNCTION real element_force_scale(Membrane m, MembraneEdges place, MembraneEdges velocity) {
  Gradient f = gradient(m, place), change = gradient(m, velocity);
  real size = dot(f.warp, f.warp) + dot(f.weft, f.weft) + real(1.0);
  real speed = sqrt(dot(change.warp, change.warp) + dot(change.weft, change.weft));
  real coupling = max(m.coupling, -m.coupling);
  return (max(m.warp, m.weft) + coupling + m.shear) * (size + m.damping * speed * sqrt(size)) * sqrt(size) *
         sqrt(largest_share_squared(m));
}

/// Second derivatives of energy and dissipation with respect to the corner's place and velocity: those of the strain
/// times K, and those that the present stress gives. Where the stress presses, these make the matrix indefinite, and
/// implicit methods drop that part.
struct MembraneHessian {
  Gradient f;
  Membrane law;
  vec3 stress;  // area times stress [N m]
};

FUNCTION MembraneHessian element_hessian(Membrane m, MembraneEdges place) {
  MembraneHessian h;
  h.f = gradient(m, place);
  h.law = m;
  h.stress = membrane_stress(m, green_strain(h.f));
  return h;
}

/// A stress without its pressing part: the positive semi-definite part of [[x, z], [z, y]].
FUNCTION vec3 pulling_part(vec3 stress) {
  real middle = real(0.5) * (stress.x + stress.y), half_difference = real(0.5) * (stress.x - stress.y);
  real radius = sqrt(half_difference * half_difference + stress.z * stress.z);
  if (middle >= radius) return stress;
  if (middle <= -radius) return vec3(real(0.0));
  real share = real(0.5) * (middle + radius) / radius;
  return share * vec3(radius + half_difference, radius - half_difference, stress.z);
}

/// The Hessian without the part that makes it indefinite.
FUNCTION MembraneHessian element_definite(MembraneHessian h) {
  h.stress = pulling_part(h.stress);
  return h;
}

/// The Hessian without the stress that rounding of a rest shape leaves.
FUNCTION MembraneHessian without_rounding(MembraneHessian h) {
  real largest = max(max(h.stress.x, h.stress.y), max(h.stress.z, -h.stress.z));
  if (largest < real(1e-9) * max(h.law.warp, h.law.weft)) h.stress = vec3(real(0.0));
  return h;
}

/// A matrix that is at least the element's: a definite one's is itself.
FUNCTION MembraneHessian element_bound(MembraneHessian h) { return h; }

/// A matrix of a triangle: `scale` times the part of K, and a part of stress.
struct MembraneMatrix {
  Gradient f;
  Membrane law;
  vec3 stress;
  real scale;
};

FUNCTION MembraneMatrix membrane_matrix(MembraneHessian h, real scale, vec3 stress) {
  MembraneMatrix matrix;
  matrix.f = h.f;
  matrix.law = h.law;
  matrix.stress = stress;
  matrix.scale = scale;
  return matrix;
}

FUNCTION MembraneMatrix stiffness_matrix(MembraneHessian h) { return membrane_matrix(h, real(1.0), h.stress); }

FUNCTION MembraneMatrix damping_matrix(MembraneHessian h) {
  return membrane_matrix(h, h.law.damping, vec3(real(0.0)));
}

/// Matrix dt C + dt^2 K of an implicit step of dt [s], without the part that makes it indefinite [kg].
FUNCTION MembraneMatrix step_matrix(MembraneHessian h, real dt) {
  return membrane_matrix(h, dt * (dt + h.law.damping), dt * dt * pulling_part(h.stress));
}

/// The corner's row of the matrix, times a vector of all corners.
FUNCTION vec3 matrix_product(MembraneMatrix m, MembraneEdges vector) {
  Gradient change = gradient(m.law, vector);
  vec3 stress_change = m.scale * membrane_stress(m.law, strain_change(m.f, change));
  return -(pull(m.law, m.f, stress_change) + pull(m.law, change, m.stress));
}

/// Adds the corner's own 3x3 block: its diagonal, and its off-diagonal (21, 31, 32).
FUNCTION void add_block(MembraneMatrix m, INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  real warp = m.law.first_warp + m.law.second_warp, weft = m.law.first_weft + m.law.second_weft;
  real along_warp = m.scale * (m.law.warp * warp * warp + m.law.shear * weft * weft);
  real along_weft = m.scale * (m.law.weft * weft * weft + m.law.shear * warp * warp);
  real mixed = m.scale * (m.law.coupling + m.law.shear) * warp * weft;
  vec3 p = m.f.warp, q = m.f.weft;
  vec3 u = along_warp * p + mixed * q, v = mixed * p + along_weft * q;  // the block is p u^T + q v^T + stress I
  diagonal +=
      p * u + q * v + (m.stress.x * warp * warp + m.stress.y * weft * weft + real(2.0) * m.stress.z * warp * weft);
  off_diagonal += vec3(p.y * u.x + q.y * v.x, p.z * u.x + q.z * v.x, p.z * u.y + q.z * v.y);
}

/// Smallest ratio of damping to stiffness [s] of any motion that the triangle resists.
FUNCTION real least_damping_time(MembraneHessian h) {
  return dot(h.stress, h.stress) > real(0.0) ? real(0.0) : h.law.damping;
}

/// See spring.glsl.
FUNCTION void add_descent(Membrane m, real dt, MembraneEdges place, MembraneEdges moved, INOUT(vec3) residual,
                          INOUT(vec3) diagonal, INOUT(vec3) off_diagonal) {
  Gradient f = gradient(m, place);
  vec3 strain = green_strain(f), strained = strain_change(f, gradient(m, moved));
  PRECISE vec3 stress = (dt * dt) * membrane_stress(m, strain);
  PRECISE vec3 damped = (dt * m.damping) * membrane_stress(m, strained);
  residual += pull(m, f, stress + damped);
  MembraneMatrix matrix;
  matrix.f = f;
  matrix.law = m;
  matrix.stress = pulling_part(stress);
  matrix.scale = dt * (dt + m.damping);
  add_block(matrix, diagonal, off_diagonal);
}

/// The triangle during a line search, which moves the corners from here in proportion to a share.
struct MembraneLine {
  vec3 strain;                            // at the search's start
  vec3 first, second;                     // its change: share * first + share^2 * second
  vec3 strain_rate, strain_rate_change;   // [1/s], and its change in a whole step of the search
};

/// `change` [m/s]: change of velocity in a whole step of the search; over dt [s] it moves the corners, too. The change
/// of place is left without dt: line_energy knows it.
FUNCTION MembraneLine element_line(Membrane m, MembraneEdges place, MembraneEdges velocity, MembraneEdges change) {
  Gradient f = gradient(m, place), g = gradient(m, change);
  MembraneLine line;
  line.strain = green_strain(f);
  line.strain_rate = strain_change(f, gradient(m, velocity));
  line.strain_rate_change = line.first = strain_change(f, g);
  line.second = vec3(real(0.5) * dot(g.warp, g.warp), real(0.5) * dot(g.weft, g.weft), dot(g.warp, g.weft));
  return line;
}

/// Energy and dissipation in a step of dt [J] at this share of the whole step, less those at its start.
FUNCTION real line_energy(Membrane m, MembraneLine line, real dt, real share) {
  real moved = dt * share;
  vec3 more = moved * line.first + (moved * moved) * line.second, faster = share * line.strain_rate_change;
  return real(0.5) * (dot(more, membrane_stress(m, real(2.0) * line.strain + more)) +
                      dt * m.damping * dot(faster, membrane_stress(m, real(2.0) * line.strain_rate + faster)));
}

/// One visit of a sweep of XPBD, with the Green strain as a constraint of three numbers and (area K)^-1 as its
/// compliance (Macklin, Mueller & Chentanez 2016, equation 18; one 3x3 system). `mobility` [1/kg] of the corners;
/// `pushed.d[0]`: the stress times area dt^2 that has acted in the step so far [kg m^2], along warp, along weft, shear.
/// Returns what the first corner gets and each other corner gives [kg m].
FUNCTION MembraneEdges element_visit(Membrane m, ConstraintGains gains, real mobility[3], MembraneEdges place,
                                     MembraneEdges moved, INOUT(MembraneEdges) pushed) {
  Gradient f = gradient(m, place);
  real stiff = gains.stretch + gains.damping * m.damping;
  vec3 lacking = -gains.stretch * membrane_stress(m, green_strain(f)) -
                 (gains.damping * m.damping) * membrane_stress(m, strain_change(f, gradient(m, moved))) - pushed.d[0];
  // The corners' mobility, felt by the strain: a symmetric 3x3 matrix.
  real third_warp = -(m.first_warp + m.second_warp), third_weft = -(m.first_weft + m.second_weft);
  real warp_warp = mobility[0] * third_warp * third_warp + mobility[1] * m.first_warp * m.first_warp +
                   mobility[2] * m.second_warp * m.second_warp;
  real warp_weft = mobility[0] * third_warp * third_weft + mobility[1] * m.first_warp * m.first_weft +
                   mobility[2] * m.second_warp * m.second_weft;
  real weft_weft = mobility[0] * third_weft * third_weft + mobility[1] * m.first_weft * m.first_weft +
                   mobility[2] * m.second_weft * m.second_weft;
  real c00 = dot(f.warp, f.warp), c01 = dot(f.warp, f.weft), c11 = dot(f.weft, f.weft);
  real w02 = warp_warp * c01 + warp_weft * c00, w12 = warp_weft * c11 + weft_weft * c01;
  vec3 column0 = stiff * membrane_stress(m, vec3(warp_warp * c00, warp_weft * c01, w02));
  vec3 column1 = stiff * membrane_stress(m, vec3(warp_weft * c01, weft_weft * c11, w12));
  vec3 column2 =
      stiff * membrane_stress(m, vec3(w02, w12, warp_warp * c11 + real(2.0) * warp_weft * c01 + weft_weft * c00));
  column0.x += real(1.0);
  column1.y += real(1.0);
  column2.z += real(1.0);
  vec3 normal = cross(column1, column2);
  real inverse = real(1.0) / dot(column0, normal);
  vec3 change = inverse * vec3(dot(lacking, normal), dot(column0, cross(lacking, column2)),
                               dot(column0, cross(column1, lacking)));
  pushed.d[0] += change;
  MembraneEdges push;
  push.d[0] = -((change.x * m.first_warp + change.z * m.first_weft) * f.warp +
                (change.y * m.first_weft + change.z * m.first_warp) * f.weft);
  push.d[1] = -((change.x * m.second_warp + change.z * m.second_weft) * f.warp +
                (change.y * m.second_weft + change.z * m.second_warp) * f.weft);
  return push;
}

#ifndef __cplusplus
#define Membrane_OF(NUMBER) \
  Membrane(NUMBER(0), NUMBER(1), NUMBER(2), NUMBER(3), NUMBER(4), NUMBER(5), NUMBER(6), NUMBER(7), NUMBER(8))
#endif
