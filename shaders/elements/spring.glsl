// A damped spring between two vertices: Hooke's law, and damping along the spring only.
// Provot 1995, section 2. In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// Force [N] on the vertex at x with velocity v, from a spring to the vertex at y with velocity w.
/// rest_length [m], stiffness [N/m], damping [N s/m]. A spring without length has no direction and gives no force.
/// The damping is the projection of the relative velocity on the spring: a rigid rotation feels none.
FUNCTION vec3 spring_force(vec3 x, vec3 y, vec3 v, vec3 w, real rest_length, real stiffness, real damping) {
  vec3 d = x - y;
  real length_squared = dot(d, d);
  real inverse_length = length_squared > real(0.0) ? real(1.0) / sqrt(length_squared) : real(0.0);
  vec3 n = d * inverse_length;
  real length_now = length_squared * inverse_length;
  real tension = stiffness * (length_now - rest_length) + damping * dot(n, v - w);
  return n * (-tension);
}

/// The second derivative of the energy with respect to x, -df/dx [N/m], in parts: along n n^T + across (I - n n^T),
/// with n the spring's direction. `across` is negative in a compressed spring: that part makes the matrix indefinite,
/// and implicit methods drop it (Choi & Ko 2002, section 4). A spring without length gives stiffness times the unit
/// matrix.
FUNCTION void spring_hessian(vec3 x, vec3 y, real rest_length, real stiffness, OUT(vec3) n, OUT(real) along,
                             OUT(real) across) {
  vec3 d = x - y;
  real length_squared = dot(d, d);
  real inverse_length = length_squared > real(0.0) ? real(1.0) / sqrt(length_squared) : real(0.0);
  n = d * inverse_length;
  along = stiffness;
  across = stiffness * (real(1.0) - rest_length * inverse_length);
}

/// Elastic energy [J] of the spring.
FUNCTION real spring_energy(vec3 x, vec3 y, real rest_length, real stiffness) {
  vec3 d = x - y;
  real stretch = sqrt(dot(d, d)) - rest_length;
  return real(0.5) * stiffness * stretch * stretch;
}

/// |l/L - 1|; 0 for a spring that has no rest length.
FUNCTION real spring_strain(vec3 x, vec3 y, real rest_length) {
  vec3 d = x - y;
  real stretch = sqrt(dot(d, d)) - rest_length;
  return rest_length > real(0.0) ? max(stretch, -stretch) / rest_length : real(0.0);
}

/// One visit of a Gauss-Seidel sweep to a spring, in PBD and XPBD (Mueller et al. 2007, section 3.3; Macklin et al.
/// 2016, equations 18 and 26): what more it gives its first end and takes from its second, as an impulse times dt [kg
/// m]. `d` is the difference of its ends as they are now, `moved` how that has changed since the step's start, `pushed`
/// what it has given since then. The gains follow from stiffness, damping, masses and dt: server/model/spring_gains.h.
/// What was given along a direction that the spring no longer has is turned to the one it has now; XPBD as published
/// leaves it, and so ends beside implicit Euler's solution when springs turn within a step. `turning` = w k dt^2, with
/// w the sum of the ends' inverse masses, takes into account that the spring itself resists (Newton's method, if it is
/// stretched).
FUNCTION vec3 spring_projection(vec3 d, vec3 moved, real rest_length, real stretch_gain, real damping_gain,
                                real memory, real turning, vec3 pushed) {
  real length_squared = dot(d, d);
  if (!(length_squared > real(0.0))) return vec3(real(0.0));
  real inverse_length = real(1.0) / sqrt(length_squared);
  vec3 n = d * inverse_length;
  real stretch = length_squared * inverse_length - rest_length;
  real along = dot(n, pushed);
  real change = -(stretch_gain * stretch + damping_gain * dot(n, moved) + memory * along);
  real resisted = turning * inverse_length * max(stretch, -stretch);
  return n * change - (pushed - n * along) * (real(1.0) / (real(1.0) + resisted));
}
