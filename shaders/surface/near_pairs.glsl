// The near pairs of a step: three texels each: the pair; n and gap; weights (elements/surface.glsl).
READ_UVEC4(near_pairs, unit_near_pairs);
// Of each vertex two texels (vertex_contacts.glsl).
READ_UVEC4(vertex_contacts, unit_vertex_contacts);

/// Most pairs that push (`texel` 0), or shorten steps at (1), a corner that gives way: each takes that share, lest they
/// do too much.
float crowd(uvec4 corner, vec4 mobility, uint texel) {
  uint most = 1u;
  for (int k = 0; k < 4; ++k) {
    uint pairs = FETCH(vertex_contacts, 2u * corner[k] + texel).w;
    if (mobility[k] != 0.0) most = max(most, pairs);
  }
  return float(most);
}

/// Part of what slides at a pair that it brakes in a pass of friction alone. Without the factor the magnitudes in each
/// row of the matrix of all pairs would sum to 1 at most (Gershgorin); less than 2 keeps the passes convergent, and
/// near it they stop sooner what slides.
const float over_relaxation = 1.9;
float part_that_rubs(uvec4 corner, vec4 mobility, float give) {
  float all = 0.0;
  for (int k = 0; k < 4; ++k)
    all += abs(mobility[k]) * float(FETCH(vertex_contacts, 2u * corner[k]).w) / weight_units;
  return min(over_relaxation * give / all, 1.0);
}
