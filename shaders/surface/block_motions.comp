// How each block of triangles has moved since the last search, for blocks.comp: as a rigid body, and how far its
// vertices are from that; and the same without its rotation.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(position_when_built, unit_position_when_built);
READ_UINT(block_vertices, unit_block_vertices);  // where each block's list ends, then the lists
// Of each block six texels: blocks.comp, Block.
layout(std430, binding = slot_block_motions) writeonly buffer BlockMotions { vec4 block_motions[]; };
uniform int block_count;  // at most GROUP_SIZE

vec3 built(uint vertex) { return FETCH(position_when_built, vertex).xyz; }
vec3 now(uint vertex) { return FETCH(position, vertex).xyz; }

/// An orthonormal frame of two directions; its third is 0 if they are too near each other.
mat3 frame(vec3 one, vec3 other) {
  vec3 normal = cross(one, other);
  float size = length(normal);
  if (!(size > 1e-3 * length(one) * length(other))) return mat3(0.0);
  normal /= size;
  vec3 along = normalize(one);
  return mat3(along, cross(normal, along), normal);
}

/// The rotation of the triangle of a block's first three vertices. Any rotation will do: a good one leaves little.
mat3 rotation(uint begin) {
  uint a = FETCH_UINT(block_vertices, begin), b = FETCH_UINT(block_vertices, begin + 1u);
  uint c = FETCH_UINT(block_vertices, begin + 2u);
  mat3 before = frame(built(b) - built(a), built(c) - built(a)), after = frame(now(b) - now(a), now(c) - now(a));
  return before[2] != vec3(0.0) && after[2] != vec3(0.0) ? after * transpose(before) : mat3(1.0);
}

void main() {
  int block = int(gl_GlobalInvocationID.x);
  if (block >= block_count) return;
  uint begin = block > 0 ? FETCH_UINT(block_vertices, block - 1) : uint(block_count);
  uint end = FETCH_UINT(block_vertices, block), first = FETCH_UINT(block_vertices, begin);
  mat3 turn = rotation(begin);
  vec3 origin = built(first), moved_origin = now(first);
  // Boxes of the places at the search, of what the rotation leaves of the motions, and of the motions.
  vec3 low = vec3(1e30), high = -low, low_left = low, high_left = high, low_motion = low, high_motion = high;
  for (uint k = begin; k < end; ++k) {
    uint vertex = FETCH_UINT(block_vertices, k);
    vec3 before = built(vertex) - origin, after = now(vertex) - moved_origin;
    vec3 left = after - turn * before, motion = after - before;
    low = min(low, before);
    high = max(high, before);
    low_left = min(low_left, left);
    high_left = max(high_left, left);
    low_motion = min(low_motion, motion);
    high_motion = max(high_motion, motion);
  }
  vec3 middle = 0.5 * (low + high), rows[3] = vec3[](transpose(turn)[0], transpose(turn)[1], transpose(turn)[2]);
  vec3 moved = moved_origin + turn * middle + 0.5 * (low_left + high_left);
  block_motions[6 * block] = vec4(origin + middle, 0.5 * length(high - low));
  block_motions[6 * block + 1] = vec4(moved, 0.5 * length(high_left - low_left));
  block_motions[6 * block + 2] = vec4(moved_origin - origin + 0.5 * (low_motion + high_motion),
                                      0.5 * length(high_motion - low_motion));
  for (int k = 0; k < 3; ++k) block_motions[6 * block + 3 + k] = vec4(rows[k], 0.0);
}
