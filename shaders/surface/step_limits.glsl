// How much of its step each vertex takes in a pass of the filter, as bits of a float, 1 or less. Pins that follow one
// motion have one limit, lest contact tears those that it stops from the others: after those of the vertices come two
// for each motion, which passes use in turns.
uniform int pass;  // of the filter, in this step or piece

/// Where the limit of vertex i is. `tag`: of a pinned one its motion's index or -1. A body has none, whatever moves it.
int limit_of(int i, float inverse_mass, float tag) {
#if MOTION_COUNT > 0
  if (i < cloth_vertex_count && inverse_mass == 0.0 && tag >= 0.0) return vertex_count + 2 * int(tag) + pass % 2;
#endif
  return i;
}
