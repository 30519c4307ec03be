// Totals over all work groups of sums that each has written, ROWS of them. Needs group_sums.glsl and `group_sums`.

uniform int group_count;

/// Total of the sums number `row`, in every work group.
vec4 total(int row) {
  vec4 all = vec4(0.0);
#ifdef FEW_GROUPS  // too few to be worth a barrier
  for (int group = 0; group < group_count; ++group) all += FETCH(group_sums, ROWS * group + row);
  return all;
#else
  for (int group = int(gl_LocalInvocationID.x); group < group_count; group += GROUP_SIZE)
    all += FETCH(group_sums, ROWS * group + row);
  return sum_of_group(all);
#endif
}
