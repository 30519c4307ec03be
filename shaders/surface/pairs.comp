// Pair search, 8 of 10: the candidates that are near each other, not their boxes alone: now, or ahead in the direction
// that divides them now.
#include "surface.glsl"
#include "expected.glsl"
READ_VEC4(body_places, unit_body_places);  // home, motion; friction, restitution, a box's corner
READ_UVEC4(candidate_list, unit_near_pairs);
layout(std430, binding = slot_surface_pairs) writeonly buffer Pairs { uvec4 list[]; };

/// True if the cloth of a pair of cloth and a box has its nearest point within the box, where the box was put or the
/// cloth started. Such a pair would keep the cloth in; vertices are pushed out without it. `c`: the corners' places
/// less `origin`.
bool within_box(uvec4 corner, Corners c, vec3 origin, Separation apart) {
  int body = int(max(corner.x, corner.w)) - cloth_vertex_count;
  int first = body < 0 ? -1 : int(FETCH(body_places, 2 * body + 1).z);
  vec3 nearest = vec3(0.0), from = place_at_search(uint(max(first, 0))) - origin;
  for (int k = 0; k < 4; ++k)
    if (int(corner[k]) < cloth_vertex_count) nearest += abs(apart.weight[k]) * c.x[k];
  bool within = first >= 0;
  for (int axis = 0; axis < 3; ++axis) {
    vec3 side = place_at_search(uint(max(first, 0) + (1 << axis))) - origin - from;
    float along = dot(nearest - from, side);
    within = within && along > 0.0 && along < dot(side, side);
  }
  return within;
}

void main() {
  uint item = gl_GlobalInvocationID.x;
  if (item >= min(known.candidates, 3u * pair_capacity)) return;
  uvec4 pair = FETCH(candidate_list, item), corner = corners_of(pair);
  bool edges = is_edges(pair), flat_at_rest = (pair.y & no_force_bit) != 0u;
  vec3 origin = place_at_search(corner.x);
  Corners c, ahead;
  for (int k = 0; k < 4; ++k) {
    c.x[k] = place_at_search(corner[k]) - origin;
    ahead.x[k] = c.x[k] + expected_motion(corner[k]);
  }
  float reach = reach_of(flat_at_rest ? next_flat_query() : next_query());
  Separation apart = separation(edges, c);
  if (min(apart.gap, gap_along(edges, ahead, apart.n)) < reach && !within_box(corner, c, origin, apart)) {
    uint slot = atomicAdd(control.pairs, 1u);
    if (slot < pair_capacity) {
      if (slot % uint(GROUP_SIZE) == 0u) {
        atomicMax(control.pair_groups, slot / uint(GROUP_SIZE) + 1u);
        atomicMax(control.rest_groups, slot / uint(GROUP_SIZE) + 1u);
      }
      list[slot] = pair;
    }
  }
}
