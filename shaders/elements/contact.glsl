// A vertex against a solid: where it is stopped, and what is left of its velocity.
// Bridson, Fedkiw & Anderson 2002, sections 4 and 6 (velocity-level contact, Coulomb friction as an impulse).
// In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// The share of its sliding, along a surface with unit normal n, that friction (Coulomb coefficient) leaves a vertex
/// that meets it with the relative velocity v.
FUNCTION real sliding_kept(vec3 v, vec3 n, real friction, real restitution) {
  real approach = -dot(v, n);
  if (!(approach > real(0.0))) return real(1.0);
  vec3 sliding = v + n * approach;
  real speed = sqrt(dot(sliding, sliding));
  real lost = friction * (real(1.0) + restitution) * approach;
  return speed > lost ? real(1.0) - lost / speed : real(0.0);
}

/// What a contact leaves of the velocity v relative to the surface with unit normal n: the approaching part is
/// turned back by restitution [0, 1]; friction (Coulomb coefficient) takes at most that impulse from the sliding part.
FUNCTION vec3 contact_velocity(vec3 v, vec3 n, real friction, real restitution) {
  real approach = -dot(v, n);
  if (!(approach > real(0.0))) return v;
  vec3 sliding = v + n * approach;
  return sliding * sliding_kept(v, n, friction, restitution) + n * (restitution * approach);
}

/// What friction takes from the displacement `moved` [m] of a step whose end velocity was v, both relative to the
/// surface: as large a share as of the sliding. What is not taken would be a creep of what should stand, and, as the
/// force of a stiff spring moves a vertex that friction stops in every step, a vibration that grows below the step
/// limit.
FUNCTION vec3 contact_braking(vec3 moved, vec3 v, vec3 n, real friction, real restitution) {
  return (moved - n * dot(moved, n)) * (real(1.0) - sliding_kept(v, n, friction, restitution));
}

/// The path from -> to, relative to a sphere's centre at either time, against the sphere: a swept test, so that a
/// fast vertex does not pass through. True if they meet; then `stopped` is on or outside the sphere (entry point plus
/// the rest of the path along the tangent plane) and `normal` the unit normal there.
/// At the very centre there is no direction: no contact, and never NaN.
FUNCTION bool sphere_contact(vec3 from, vec3 to, real radius, OUT(vec3) stopped, OUT(vec3) normal) {
  vec3 path = to - from;
  real a = dot(path, path);
  real b = dot(from, path);
  real c = dot(from, from) - radius * radius;
  real discriminant = b * b - a * c;
  stopped = to;
  normal = vec3(real(0.0));

  real s = real(0.0);  // the share of the path before contact
  if (c > real(0.0)) {
    if (!(b < real(0.0)) || !(discriminant > real(0.0))) return false;
    real reach = -b - sqrt(discriminant);
    if (reach > a) return false;
    s = reach / a;
  } else if (!(b < real(0.0))) {
    if (!(dot(to, to) < radius * radius)) return false;
    s = real(1.0);  // on its way out, but not out yet
  }
  vec3 met = from + path * s;
  real distance_squared = dot(met, met);
  if (!(distance_squared > real(0.0))) return false;
  normal = met * (real(1.0) / sqrt(distance_squared));
  vec3 left = path * (real(1.0) - s);
  stopped = normal * radius + left - normal * min(dot(left, normal), real(0.0));
  return true;
}

/// Two vertices of cloth, at x and y with velocities v and w, that keep a distance of `keep` [m]: what moves the first
/// away from the second by position (push) and by velocity (impulse), to be shared between the two. True if they touch:
/// too close already, or they would be within this step of dt. Takes out the approaching velocity that is more than the
/// room between them, with friction, and mends a fifth of an overlap a step: all of it at once would stretch the
/// springs and so add energy. Speculative contacts: Catto 2013. Two vertices in one place have no direction: no
/// contact.
FUNCTION bool self_contact(vec3 x, vec3 y, vec3 v, vec3 w, real keep, real friction, real dt, OUT(vec3) push,
                           OUT(vec3) impulse) {
  push = vec3(real(0.0));
  impulse = vec3(real(0.0));
  vec3 d = x - y;
  real gap = sqrt(dot(d, d));
  if (!(gap > real(0.0))) return false;
  vec3 n = d * (real(1.0) / gap);
  real room = gap - keep;
  vec3 relative = v - w + n * (max(room, real(0.0)) / dt);
  if (room >= real(0.0) && dot(relative, n) >= real(0.0)) return false;
  push = n * (real(0.2) * max(-room, real(0.0)));
  impulse = contact_velocity(relative, n, friction, real(0.0)) - relative;
  return true;
}

/// The part of a displacement that friction takes: `moved` [m] is that of a step relative to a surface with unit normal
/// n which pushed back by `depth` [m] (Coulomb's law for positions: Macklin et al. 2014, equation 24).
FUNCTION vec3 friction_displacement(vec3 moved, vec3 n, real friction, real depth) {
  vec3 sliding = moved - n * dot(moved, n);
  real distance_slid = sqrt(dot(sliding, sliding));
  real most = friction * depth;
  return distance_slid > most ? sliding * (most / distance_slid) : sliding;
}

/// Two vertices of cloth that keep a distance of `keep` [m], their difference at the step's start and now: swept, as
/// for a sphere. True if they meet; `correction` then goes to the first, less the second's share. If they started
/// closer than `keep` already, no more than the share `mend` of what lacks is asked for: all of it at once would be a
/// blow.
FUNCTION bool pair_contact(vec3 before, vec3 now, real keep, real friction, real mend, OUT(vec3) correction) {
  correction = vec3(real(0.0));
  real gap = sqrt(dot(before, before));
  real kept = gap < keep ? gap + mend * (keep - gap) : keep;
  vec3 stopped, n;
  if (!sphere_contact(before, now, kept, stopped, n)) return false;
  correction = stopped - now;
  real depth = dot(correction, n);
  correction = correction - friction_displacement(stopped - before, n, friction, depth);
  return true;
}
