// From which distance on a pair presses. Needs term.glsl.
READ_VEC4(rest_position, unit_rest_position);  // w: the cloth

/// The thickness, but within a cloth at most half of the pair's distance at rest, and of parts that lie side by side at
/// rest less than the search reaches for them. [m]
float radius_of(uvec4 pair) {
  uvec4 corner = corners_of(pair);
  bool edges = is_edges(pair), flat_at_rest = (pair.y & no_force_bit) != 0u;
  if (int(max(corner.x, corner.w)) >= cloth_vertex_count) return thickness;
  vec4 origin = FETCH(rest_position, corner.x);
  bool one_cloth = true;
  Corners c;
  for (int k = 0; k < 4; ++k) {
    vec4 x = FETCH(rest_position, corner[k]);
    one_cloth = one_cloth && x.w == origin.w;
    c.x[k] = x.xyz - origin.xyz;
  }
  float most = flat_at_rest ? min(thickness, 0.8 * least_query) : thickness;
  return one_cloth ? min(most, 0.5 * separation(edges, c).gap) : most;
}

/// How far a pair slides in a step before friction is all that it can be [m]: a way that cannot be seen, but so long
/// that friction's stiffness stays below that of the cloth, as otherwise rounding would be all that a solver sees.
/// `slides`: the friction that slides [N].
uniform float still_speed;  // [m/s]
const float most_rubbing = 1000.0;  // stiffness of friction, over that of inertia in a step
float still_way(float slides, vec4 inverse_mass, float rounding) {
  float lightest = max(max(inverse_mass.x, inverse_mass.y), max(inverse_mass.z, inverse_mass.w));
  return max(max(still_speed * dt, 4.0 * rounding), 2.0 * slides * dt * dt * lightest / most_rubbing);
}

/// The stiffness of a pair [N/m]: layers of its heaviest corner's mass are to rest near the radius.
uniform float stiffness_per_mass;  // [1/s^2]
float stiffness_of(vec4 inverse_mass) {
  float heaviest = 0.0;
  for (int k = 0; k < 4; ++k)
    if (inverse_mass[k] > 0.0) heaviest = max(heaviest, 1.0 / inverse_mass[k]);
  return stiffness_per_mass * heaviest;
}
