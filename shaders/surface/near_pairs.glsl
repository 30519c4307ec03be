// The near pairs of a step: three texels each: the pair; n and gap; weights (elements/surface.glsl).
READ_UVEC4(near_pairs, unit_near_pairs);
// Of each vertex two texels (vertex_contacts.glsl).
READ_UVEC4(vertex_contacts, unit_vertex_contacts);

/// Most pairs that shorten steps at a corner that gives way: each takes that share, lest they do too much.
float crowd(uvec4 corner, vec4 mobility) {
  uint most = 1u;
  for (int k = 0; k < 4; ++k) {
    uint pairs = FETCH(vertex_contacts, 2u * corner[k] + 1u).w;
    if (mobility[k] != 0.0) most = max(most, pairs);
  }
  return float(most);
}

/// Part of what a pair lacks, or of what slides at it, that it takes in a pass. With `relaxation` 1 the magnitudes in
/// each row of the matrix of all pairs sum to 1 at most (Gershgorin); less than 2 keeps the passes convergent.
float part_of_pair(uvec4 corner, vec4 mobility, float give, float relaxation) {
  float all = 0.0;
  for (int k = 0; k < 4; ++k)
    all += abs(mobility[k]) * float(FETCH(vertex_contacts, 2u * corner[k]).w) / weight_units;
  return min(relaxation * give / all, 1.0);
}
