// The energy of contact between surfaces, for methods that solve a step's problem: of a pair's distance d [m], 0 from
// the radius r [m] on, and without bound towards 0. It has two stages, as offset geometric contact has (Chen et al.
// 2025, doi 10.1145/3731205): a spring of stiffness k [N/m] to r / 2, then a logarithm, with which the force and its
// derivative go on without a jump. Friction is a potential of what the pair has slid in the step, with the force and
// the normal of the last iterate (Li et al. 2020, doi 10.1145/3386569.3392425). In the common subset of GLSL and C++
// (see types.glsl, elements.h).

/// The energy [J].
FUNCTION real contact_energy(real d, real r, real k) {
  real half_way = real(0.5) * r, overlap = max(r - max(d, half_way), real(0.0));
  real spring = real(0.5) * k * overlap * overlap;
  return spring + k * half_way * half_way * log(half_way / min(d, half_way));
}

/// What pushes the pair's parts from each other [N]: less the energy's derivative.
FUNCTION real contact_force(real d, real r, real k) {
  real half_way = real(0.5) * r;
  return d < half_way ? k * half_way * half_way / d : k * max(r - d, real(0.0));
}

/// The energy's second derivative [N/m].
FUNCTION real contact_stiffness(real d, real r, real k) {
  real half_way = real(0.5) * r;
  return d < half_way ? k * half_way * half_way / (d * d) : d < r ? k : real(0.0);
}

/// The energy of friction [J] over the friction that slides [N]: of the way slid [m]. It is quadratic up to `still`
/// [m]: what slides less far in a step is held.
FUNCTION real friction_energy(real slid, real still) {
  real share = min(slid / still, real(1.0));
  return still * share * share * (real(1.0) - share / real(3.0)) + max(slid - still, real(0.0));
}

/// The force of friction over the friction that slides and over the way slid [1/m]: also the part of the second
/// derivative that has no negative direction.
FUNCTION real friction_stiffness(real slid, real still) {
  return slid < still ? (real(2.0) - slid / still) / still : real(1.0) / slid;
}

/// By how much that is more than the second derivative along the way slid [1/m].
FUNCTION real friction_excess(real slid, real still) {
  return slid < still ? slid / (still * still) : real(1.0) / slid;
}

/// The largest share, up to `most`, of its corners' ways that keeps a pair as far apart as `keep` [m] on all its way
/// along n, which divides it. [0, 1]
FUNCTION real share_along(bool edges, Corners c, Corners way, vec3 n, real keep, real most) {
  real share = most;
  for (int k = 0; k < 2; ++k)
    for (int m = 1; m < 4; ++m) {
      bool of_both = edges ? m > 1 : k == 0;
      real approach = dot(n, way.x[m] - way.x[k]), room = dot(n, c.x[k] - c.x[m]) - keep;
      if (of_both && approach > real(0.0)) share = min(share, max(room, real(0.0)) / approach);
    }
  return share;
}

/// The same along whichever directions divide the pair on its way: a lower bound of the share at which it is `keep`
/// apart, which a few directions bring near to it (conservative advancement: Mirtich 1996). `c` and `way` are relative
/// to a point near the pair.
FUNCTION real share_apart(bool edges, Corners c, Corners way, real keep) {
  const int directions = 6;
  real share = real(0.0);
  for (int step = 0; step < directions && share < real(1.0); ++step) {
    Corners there;
    for (int k = 0; k < 4; ++k) there.x[k] = c.x[k] + way.x[k] * share;
    vec3 n = separation(edges, there).n;
    real next = share_along(edges, c, way, n, keep, real(1.0));
    if (!(next > share)) break;
    share = next;
  }
  return share;
}
