// Validity of the listed pairs, in one work group: asks for a search if two blocks of triangles have moved so far,
// relative to each other, that a pair which the last search left out may be near now. Motion that both share, such as
// a falling or a swinging cloth's, does not count. A pair that was left out was farther apart than the search
// reached, and no nearer than the boxes of its blocks; how much nearer it came is at most the largest relative motion
// of its corners.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(position_when_built, unit_position_when_built);
READ_UINT(block_vertices, unit_block_vertices);  // where each block's list ends, then the lists
uniform int block_count;                         // at most GROUP_SIZE
uniform int cloth_block_count;                   // those of bodies come after them, and do not meet each other

const float rounding = 1.001;

// For each block the box about its vertices at the last search, and the box about their motions since.
shared vec3 low[GROUP_SIZE], high[GROUP_SIZE], motion_low[GROUP_SIZE], motion_high[GROUP_SIZE];

void measure(int block) {
  uint begin = block > 0 ? FETCH_UINT(block_vertices, block - 1) : uint(block_count);
  uint end = FETCH_UINT(block_vertices, block);
  vec3 least = vec3(1e30), most = vec3(-1e30), least_motion = least, most_motion = most;
  for (uint k = begin; k < end; ++k) {
    uint vertex = FETCH_UINT(block_vertices, k);
    vec3 built = FETCH(position_when_built, vertex).xyz, moved = FETCH(position, vertex).xyz - built;
    least = min(least, built);
    most = max(most, built);
    least_motion = min(least_motion, moved);
    most_motion = max(most_motion, moved);
  }
  low[block] = least;
  high[block] = most;
  motion_low[block] = least_motion;
  motion_high[block] = most_motion;
}

/// True if no pair of this block and another can be near that is not listed.
bool valid(int one) {
  vec3 at = low[one], to = high[one], least_motion = motion_low[one], most_motion = motion_high[one];
  bool all_valid = true;
  // Each two blocks once: every block looks at the half of the ring that begins with itself.
  for (int k = 0; k <= block_count / 2; ++k) {
    int other = one + k < block_count ? one + k : one + k - block_count;
    vec3 relative = max(abs(most_motion - motion_low[other]), abs(least_motion - motion_high[other]));
    vec3 between = max(max(at - high[other], low[other] - to), vec3(0.0));
    float room = max(length(between) - uintBitsToFloat(known.query), skin);
    bool may_meet = one < cloth_block_count || other < cloth_block_count;
    all_valid = all_valid && (!may_meet || rounding * length(relative) <= room);
  }
  return all_valid;
}

void main() {
  int block = int(gl_LocalInvocationID.x);
  if (block < block_count) measure(block);
  barrier();
  if (block < block_count && !valid(block))
    control.rebuild_groups = uint((max(vertex_count, triangle_count) + GROUP_SIZE - 1) / GROUP_SIZE);
}
