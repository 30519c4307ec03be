// The near pairs of a step: three texels each: the pair; n and gap; weights (elements/surface.glsl).
READ_UVEC4(near_pairs, unit_near_pairs);
// Which of them push in this step, and from pair_capacity on which could meet.
layout(std430, binding = slot_chosen_pairs) buffer Chosen { uint chosen_pairs[]; };
// For each vertex: sums of pushes x, y, z [units of length], pairs that share it; sums of impulses x, y, z [units of
// speed], pairs that shorten steps at it. Of pairs whose other part gives no way: weighted sums of how far, and by how
// much faster, it must go, 8 to 10 and 12 to 14, in the same units, and of weights, 11 [1 / weight_units]. Pairs that
// share it in the next pass, 15; before a pass of friction alone 3 and 15 are sums of weights [1 / weight_units].
layout(std430, binding = slot_contact_sums) buffer Sums { int sums[]; };

/// Most pairs that push, or shorten steps at, a corner that gives way: each takes that share, lest they do too much.
float crowd(uvec4 corner, vec4 mobility, int which) {
  int most = 1;
  for (int k = 0; k < 4; ++k)
    if (mobility[k] != 0.0) most = max(most, sums[SUMS * int(corner[k]) + which]);
  return float(most);
}

/// Part of what slides at a pair that it brakes in a pass of friction alone. Without the factor the magnitudes in each
/// row of the matrix of all pairs would sum to 1 at most (Gershgorin); less than 2 keeps the passes convergent, and
/// near it they stop sooner what slides.
const float over_relaxation = 1.9;
float part_that_rubs(uvec4 corner, vec4 mobility, float give) {
  float all = 0.0;
  for (int k = 0; k < 4; ++k)
    if (mobility[k] != 0.0) all += abs(mobility[k]) * float(sums[SUMS * int(corner[k]) + 3]) / weight_units;
  return min(over_relaxation * give / all, 1.0);
}

void add(uint corner, int first, vec3 units) {
  ivec3 whole = in_units(units);
  for (int axis = 0; axis < 3; ++axis)
    if (whole[axis] != 0) atomicAdd(sums[SUMS * int(corner) + first + axis], whole[axis]);
}
