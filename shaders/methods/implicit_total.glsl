// Totals over all work groups of the SUMS_AT_ONCE sums that each has written. Needs group_sums.glsl and `group_sums`.

uniform int group_count;

/// In every work group.
void read_totals(out vec4 all[SUMS_AT_ONCE]) {
  for (int s = 0; s < SUMS_AT_ONCE; ++s) all[s] = vec4(0.0);
#ifdef FEW_GROUPS  // too few to be worth a barrier
  const int first = 0, count = 1;
#else
  const int first = int(gl_LocalInvocationID.x), count = GROUP_SIZE;
#endif
  for (int group = first; group < group_count; group += count)
    for (int s = 0; s < SUMS_AT_ONCE; ++s) all[s] += FETCH(group_sums, SUMS_AT_ONCE * group + s);
#ifndef FEW_GROUPS
  sums_of_group(all, true);
#endif
}
