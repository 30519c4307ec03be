// How each block of triangles has moved since the last search, other than the search expected, for blocks.comp.
#include "surface.glsl"
#include "expected.glsl"
READ_VEC4(position, unit_position);
READ_UINT(block_vertices, unit_block_vertices);  // where each block's list ends, then the lists
// Of each block two texels: blocks.comp, Block.
layout(std430, binding = slot_block_motions) writeonly buffer BlockMotions { vec4 block_motions[]; };
uniform int block_count;  // at most GROUP_SIZE
uniform float later;      // `position` is where vertices will be so much later [s]

void main() {
  int block = int(gl_GlobalInvocationID.x);
  if (block >= block_count) return;
  // A vertex is expected to move straight on, as far ahead as the search looked, and no farther.
  float ahead = uintBitsToFloat(known.ahead), since = uintBitsToFloat(known.since) + later;
  float share = ahead > 0.0 ? min(since / ahead, 1.0) : 0.0;
  uint begin = block > 0 ? FETCH_UINT(block_vertices, block - 1) : uint(block_count);
  uint end = FETCH_UINT(block_vertices, block);
  // Boxes of the places that the search expected, and of what the motions were beyond that.
  vec3 low = vec3(1e30), high = -low, low_motion = low, high_motion = high;
  for (uint k = begin; k < end; ++k) {
    uint vertex = FETCH_UINT(block_vertices, k);
    vec3 place = place_at_search(vertex) + share * expected_motion(vertex);
    vec3 motion = FETCH(position, vertex).xyz - place;
    low = min(low, place);
    high = max(high, place);
    low_motion = min(low_motion, motion);
    high_motion = max(high_motion, motion);
  }
  block_motions[2 * block] = vec4(0.5 * (low + high), 0.5 * length(high - low));
  block_motions[2 * block + 1] = vec4(0.5 * (low_motion + high_motion), 0.5 * length(high_motion - low_motion));
}
