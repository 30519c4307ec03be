// Contact of a vertex with a solid or with another vertex: where it stops, and the velocity it keeps.
// Bridson, Fedkiw & Anderson 2002, sections 4 and 6 (velocity-level contact, Coulomb friction as an impulse).
// In the common subset of GLSL and C++ (see types.glsl, elements.h).

/// Share of its sliding velocity that a vertex keeps under friction (Coulomb coefficient), [0, 1]. v: velocity relative
/// to the surface, n: unit normal of the surface.
FUNCTION real sliding_kept(vec3 v, vec3 n, real friction, real restitution) {
  real approach = -dot(v, n);
  if (!(approach > real(0.0))) return real(1.0);
  vec3 sliding = v + n * approach;
  real speed = sqrt(dot(sliding, sliding));
  real lost = friction * (real(1.0) + restitution) * approach;
  return speed > lost ? real(1.0) - lost / speed : real(0.0);
}

/// Velocity after a contact, from the velocity v before it, both relative to the surface with unit normal n. The
/// approaching part is turned back by restitution [0, 1]; friction (Coulomb coefficient) takes at most that impulse
/// from the sliding part.
FUNCTION vec3 contact_velocity(vec3 v, vec3 n, real friction, real restitution) {
  real approach = -dot(v, n);
  if (!(approach > real(0.0))) return v;
  vec3 sliding = v + n * approach;
  return sliding * sliding_kept(v, n, friction, restitution) + n * (restitution * approach);
}

/// Displacement [m] that friction takes from a step's displacement `moved` [m]: as large a share as of the sliding
/// velocity. v: end velocity of the step; both are relative to the surface. Without it a cloth at rest would creep; and
/// a vertex that friction stops in every step while a stiff spring's force moves it would vibrate more and more even
/// below the step limit.
FUNCTION vec3 contact_braking(vec3 moved, vec3 v, vec3 n, real friction, real restitution) {
  return (moved - n * dot(moved, n)) * (real(1.0) - sliding_kept(v, n, friction, restitution));
}

/// A swept test of the path from -> to, relative to a sphere's centre at either time, against the sphere: a fast vertex
/// does not pass through. True if they meet; then `stopped` is on or outside the sphere (entry point plus the rest of
/// the path along the tangent plane) and `normal` the unit normal there.
/// At the very centre there is no direction: no contact, and never NaN.
FUNCTION bool sphere_contact(vec3 from, vec3 to, real radius, OUT(vec3) stopped, OUT(vec3) normal) {
  vec3 path = to - from;
  real a = dot(path, path);
  real b = dot(from, path);
  real c = dot(from, from) - radius * radius;
  real discriminant = b * b - a * c;
  stopped = to;
  normal = vec3(real(0.0));

  real s = real(0.0);  // share of the path before contact
  if (c > real(0.0)) {
    if (!(b < real(0.0)) || !(discriminant > real(0.0))) return false;
    real reach = -b - sqrt(discriminant);
    if (reach > a) return false;
    s = reach / a;
  } else if (!(b < real(0.0))) {
    if (!(dot(to, to) < radius * radius)) return false;
    s = real(1.0);  // leaving the sphere, but still inside
  }
  vec3 met = from + path * s;
  real distance_squared = dot(met, met);
  if (!(distance_squared > real(0.0))) return false;
  normal = met * (real(1.0) / sqrt(distance_squared));
  vec3 left = path * (real(1.0) - s);
  stopped = normal * radius + left - normal * min(dot(left, normal), real(0.0));
  return true;
}

/// Contact of two cloth vertices at x and y, with velocities v and w, that keep a distance of `keep` [m]. True if they
/// touch: they are too close already, or would be within this step of dt [s]. Then `push` [m] and `impulse` [m/s] move
/// the first away from the second; the caller shares them between the two. The impulse removes the approaching velocity
/// beyond the room between them, with friction. The push removes a fifth of an overlap per step: all of it at once
/// would stretch the springs and so add energy. Speculative contacts: Catto 2013. Two vertices in one place have no
/// direction: no contact.
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

/// Part of a displacement that friction takes [m]. `moved` [m]: displacement of a step relative to a surface with unit
/// normal n that pushed back by `depth` [m] (Coulomb's law for positions: Macklin et al. 2014, equation 24).
FUNCTION vec3 friction_displacement(vec3 moved, vec3 n, real friction, real depth) {
  vec3 sliding = moved - n * dot(moved, n);
  real distance_slid = sqrt(dot(sliding, sliding));
  real most = friction * depth;
  return distance_slid > most ? sliding * (most / distance_slid) : sliding;
}

/// A swept contact of two cloth vertices that keep a distance of `keep` [m]; `before`, `now`: the first's position less
/// the second's at the step's start and now. True if they meet; then `correction` [m] moves the first away from the
/// second, to be shared between them. If they started closer than `keep`, it removes at most the share `mend` of the
/// overlap: all of it at once would act like a blow.
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
