// Friction of implicit Euler: Coulomb's law within the solve (Baraff & Witkin 1998, section 5). A sticking vertex is
// held in all three directions while the impulse along the surface is at most the coefficient times the impulse normal
// to it. A sliding vertex gets that much against its motion, as an impulse before the solve: each neighbour that slides
// with it gets its own, and none is braked as if the others stood still. Both impulses are known only after a solve:
// they, and whether the vertex sticks, are kept for the next solve. `grip`: xyz the direction in which the vertex
// slides on the surface, a unit vector, 0 while it sticks; w the impulse of the contact [kg m/s], or one of these:
const float untouched = -1.0, pulled_away = -2.0;

vec3 along_surface(vec3 v, vec3 normal) { return v - normal * dot(normal, v); }
vec3 direction(vec3 v) {
  float size = length(v);
  return size > 0.0 ? v / size : vec3(0.0);
}

/// Velocity that friction takes from a sliding vertex [m/s].
vec3 braked(vec4 grip, float friction, float inverse_mass) {
  return grip.xyz * (friction * max(grip.w, 0.0) * inverse_mass);
}

/// Grip of a new contact, from its sliding velocity [m/s] and the impulse that keeps it off the surface [kg m/s].
vec4 first_grip(vec3 sliding, float impulse, float friction, float inverse_mass) {
  bool stopped = length(sliding) <= friction * impulse * inverse_mass;
  return vec4(stopped ? vec3(0.0) : direction(sliding), impulse);
}

/// Speed at which a vertex kept at the surface seems to leave it [m/s]: along the chord of a round surface, or out of a
/// surface that it had entered. The vertex does not get this speed, and the contact need not give it.
float leaving(vec3 u, vec4 surface, vec3 normal) { return max(dot(u - surface.xyz, normal), 0.0); }

/// Grip after a solve that left `residual`, the impulse [kg m/s] that the contact must take, and the velocity u [m/s].
/// A vertex that slid and would now slide back sticks: `overshot` [m/s] is the velocity beyond that.
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
