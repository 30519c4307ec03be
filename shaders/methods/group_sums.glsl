// Sums and maxima over all vertices, on the GPU and without atomics. Each work group writes its own; a reader adds them
// up, always in the same order.
#ifndef SUMS_AT_ONCE
#define SUMS_AT_ONCE 1  // values of a lane that sums_of_group takes
#endif
shared vec4 sums[SUMS_AT_ONCE][GROUP_SIZE];
const int summands = 16;

// A loop to `rolled(count)` is not unrolled where several sums are made at once: unrolled it takes half of the kernel's
// compilation.
#if SUMS_AT_ONCE == 1
#define rolled(count) count
#else
int rolled(int count) { return vertex_count > 0 ? count : 0; }
#endif

/// Replaces each of the values by its sum over the work group, in every lane or in the first one. It takes two rounds:
/// in software OpenGL a barrier costs more than a few sums in a row.
void sums_of_group(inout vec4 value[SUMS_AT_ONCE], const bool everywhere) {
  int lane = int(gl_LocalInvocationID.x);
  for (int s = 0; s < SUMS_AT_ONCE; ++s) sums[s][lane] = value[s];
  barrier();
  if (lane % summands == 0) {
    for (int k = 1; k < rolled(summands); ++k)
      for (int s = 0; s < SUMS_AT_ONCE; ++s) value[s] += sums[s][lane + k];
    for (int s = 0; s < SUMS_AT_ONCE; ++s) sums[s][lane] = value[s];
  }
  barrier();
  if (everywhere || lane == 0) {
    for (int s = 0; s < SUMS_AT_ONCE; ++s) value[s] = vec4(0.0);
    for (int k = 0; k < rolled(GROUP_SIZE); k += summands)
      for (int s = 0; s < SUMS_AT_ONCE; ++s) value[s] += sums[s][k];
  }
  barrier();  // before the next call writes
}

#if SUMS_AT_ONCE == 1
vec4 sum_of_group(vec4 value) {
  vec4 one[1] = vec4[](value);
  sums_of_group(one, true);
  return one[0];
}
#endif

/// Largest of the work group's values; every lane gets it.
float largest_of_group(float value) {
  int lane = int(gl_LocalInvocationID.x);
  sums[0][lane].x = value;
  barrier();
  if (lane % summands == 0) {
    for (int k = 1; k < summands; ++k) value = max(value, sums[0][lane + k].x);
    sums[0][lane].x = value;
  }
  barrier();
  float largest = sums[0][0].x;
  for (int k = summands; k < GROUP_SIZE; k += summands) largest = max(largest, sums[0][k].x);
  barrier();
  return largest;
}
