// Implicit Euler's friction: Coulomb's law within the solve (Baraff & Witkin 1998, section 5). A vertex that sticks is
// held in all three directions while what holds it along the surface is no more than the coefficient times what holds
// it off; one that slides has that much against it, as an impulse given before the solve: so neighbours that slide with
// it feel theirs, and none is braked as if the others stood. Both impulses are known after a solve alone: they, and
// whether it sticks, are kept for the next one. `grip`: xyz where to the vertex slides on the surface, as a unit
// vector, 0 while it sticks; w the impulse of the contact [kg m/s], or one of these:
const float untouched = -1.0, pulled_away = -2.0;

vec3 along_surface(vec3 v, vec3 normal) { return v - normal * dot(normal, v); }
vec3 direction(vec3 v) {
  float size = length(v);
  return size > 0.0 ? v / size : vec3(0.0);
}

/// What friction takes from the velocity of a vertex that slides [m/s].
vec3 braked(vec4 grip, float friction, float inverse_mass) {
  return grip.xyz * (friction * max(grip.w, 0.0) * inverse_mass);
}

/// The grip of a vertex of which nothing is known but how it slides, and what it takes to keep it off the surface.
vec4 first_grip(vec3 sliding, float impulse, float friction, float inverse_mass) {
  bool stopped = length(sliding) <= friction * impulse * inverse_mass;
  return vec4(stopped ? vec3(0.0) : direction(sliding), impulse);
}

/// The speed at which a vertex that is kept at the surface seems to leave it [m/s]: along the chord of a round one, or
/// out of one that it had entered. It will not have it, nor does the contact have to give it.
float leaving(vec3 u, vec4 surface, vec3 normal) { return max(dot(u - surface.xyz, normal), 0.0); }

/// The grip after a solve that left `residual`, which is what the contact has to take [kg m/s], and the velocity u. One
/// that slid and would now slide back sticks: `overshot` is what it went too far [m/s].
vec4 grip_after(vec4 grip, vec4 constraint, vec3 residual, vec3 u, vec4 surface, float inverse_mass,
                out vec3 overshot) {
  vec3 normal = constraint.xyz;
  overshot = vec3(0.0);
  float impulse = -dot(residual, normal);
  if (impulse < 0.0) return vec4(vec3(0.0), pulled_away);
  impulse = max(impulse - leaving(u, surface, normal) / inverse_mass, 0.0);
  if (sticks(constraint)) {
    vec3 load = along_surface(residual, normal);
    return vec4(length(load) > surface.w * impulse ? direction(load) : vec3(0.0), impulse);
  }
  vec3 sliding = along_surface(u - surface.xyz, normal);
  if (surface.w > 0.0 && dot(sliding, grip.xyz) <= 0.0) {
    overshot = sliding;
    sliding = vec3(0.0);
  }
  return vec4(direction(sliding), impulse);
}
