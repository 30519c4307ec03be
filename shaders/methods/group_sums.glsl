// Sums over all vertices without leaving the GPU and without atomics: each work group writes its own, and whoever needs
// the total adds those up, in the same order everywhere.
shared vec4 sums[GROUP_SIZE];

/// Of the work group's values; the result is for every lane.
vec4 sum_of_group(vec4 value) {
  int lane = int(gl_LocalInvocationID.x);
  barrier();
  sums[lane] = value;
  barrier();
  for (int half_size = GROUP_SIZE / 2; half_size > 0; half_size /= 2) {
    if (lane < half_size) sums[lane] += sums[lane + half_size];
    barrier();
  }
  return sums[0];
}
