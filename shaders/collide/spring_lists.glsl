// The springs at each vertex, for gathering: slices of SLICE_SIZE vertices, each padded to its longest list (sliced
// ELLPACK: Monakov et al. 2010), so that neighbouring threads read neighbouring entries.
#ifndef SLICE_SIZE
#define SLICE_SIZE GROUP_SIZE
#endif
READ_UVEC4(springs, 2);       // (other vertex, rest length [m], stiffness [N/m], damping [N s/m]); padding: itself, 0
READ_UINT(spring_slices, 3);  // [slices + 1] first slot of each slice

struct SpringRange { int first, end; };

/// The entries of vertex i are first, first + SLICE_SIZE, ... below end.
SpringRange spring_range(int i) {
  int slice = i / SLICE_SIZE, lane = i % SLICE_SIZE;
  return SpringRange(int(FETCH_UINT(spring_slices, slice)) * SLICE_SIZE + lane,
                     int(FETCH_UINT(spring_slices, slice + 1)) * SLICE_SIZE);
}

bool joined(int i, int j) {
  SpringRange range = spring_range(i);
  for (int entry = range.first; entry < range.end; entry += SLICE_SIZE)
    if (FETCH(springs, entry).x == uint(j)) return true;
  return false;
}
