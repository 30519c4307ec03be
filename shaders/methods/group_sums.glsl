// Sums and maxima over all vertices without leaving the GPU and without atomics: each work group writes its own, and
// whoever needs the total adds those up, in the same order everywhere.
shared vec4 sums[GROUP_SIZE];

/// Of the work group's values; the result is for every lane. In two rounds, since software OpenGL pays more for a
/// barrier than for a few sums in a row.
vec4 sum_of_group(vec4 value) {
  int lane = int(gl_LocalInvocationID.x);
  sums[lane] = value;
  barrier();
  const int summands = 16;
  if (lane % summands == 0) {
    for (int k = 1; k < summands; ++k) value += sums[lane + k];
    sums[lane] = value;
  }
  barrier();
  vec4 total = vec4(0.0);
  for (int k = 0; k < GROUP_SIZE; k += summands) total += sums[k];
  barrier();  // before the next sum
  return total;
}

/// The largest of the work group's values, for every lane.
float largest_of_group(float value) {
  int lane = int(gl_LocalInvocationID.x);
  sums[lane].x = value;
  barrier();
  const int members = 16;
  if (lane % members == 0) {
    for (int k = 1; k < members; ++k) value = max(value, sums[lane + k].x);
    sums[lane].x = value;
  }
  barrier();
  float largest = sums[0].x;
  for (int k = members; k < GROUP_SIZE; k += members) largest = max(largest, sums[k].x);
  barrier();
  return largest;
}
