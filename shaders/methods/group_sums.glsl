// Sums and maxima over all vertices, on the GPU and without atomics. Each work group writes its own; a reader adds them
// up, always in the same order.
shared vec4 sums[GROUP_SIZE];

/// Sum of the work group's values; every lane gets it. It takes two rounds: in software OpenGL a barrier costs more
/// than a few sums in a row.
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
  barrier();  // before the next call writes
  return total;
}

/// Largest of the work group's values; every lane gets it.
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
