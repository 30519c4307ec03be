// Pair search, 10 of 10: ends it until a vertex asks for another.
#include "surface.glsl"

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  control.query = floatBitsToUint(next_query());
  control.flat_query = floatBitsToUint(next_flat_query());
  control.skin = known.next_skin;
  control.ahead = known.next_ahead;
  control.since = floatBitsToUint(0.0);
  control.checks = 0u;
  // Candidates are where near pairs will be, with three times the room. What was found beyond a list's room was not
  // searched further, and what was depends on the order of threads: then only what is complete counts.
  uint room_for_candidates = (known.candidates + 2u) / 3u;
  bool all_leaves = known.leaf_pairs <= leaf_pair_capacity;
  bool all_bundles = all_leaves && known.bundle_pairs <= bundle_pair_capacity;
  bool all_triangles = all_bundles && known.triangle_pairs <= triangle_pair_capacity;
  bool all_candidates = all_triangles && room_for_candidates <= pair_capacity;
  uint needed = all_candidates ? max(known.pairs, room_for_candidates) : all_triangles ? room_for_candidates : 0u;
  bool whole = all_candidates && known.pairs <= pair_capacity;
  control.overflow = whole ? 0u : 1u;
  // A part of the pairs must not push: nothing moves in this step.
  if (!whole) control.pairs = control.pair_groups = 0u;
  control.most_leaf_pairs = max(known.most_leaf_pairs, known.leaf_pairs);
  if (all_leaves) control.most_bundle_pairs = max(known.most_bundle_pairs, known.bundle_pairs);
  if (all_bundles) control.most_triangle_pairs = max(known.most_triangle_pairs, known.triangle_pairs);
  control.most_pairs = max(known.most_pairs, needed);
  control.fastest = control.fastest_vertex = 0u;
  control.rebuild_groups = control.leaf_groups = control.bundle_groups = control.split_groups = 0u;
  control.neighbour_groups = control.candidate_groups = control.rest_groups = control.finish_groups = 0u;
  ++control.rebuilds;
}
