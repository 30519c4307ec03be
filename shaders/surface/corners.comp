// Pair search, 1 of 10: where all vertices are, once more for each triangle, and how fast the fastest is.
#include "surface.glsl"
#include "triangles.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(velocity, unit_velocity);
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: parts of triangles.glsl, of each corner in turn
layout(std430, binding = slot_triangle_corners) writeonly buffer TriangleCorners { uvec4 written_corners[]; };
layout(std430, binding = slot_surface_built) writeonly buffer Built { vec4 position_when_built[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) {
    control.leaf_pairs = control.bundle_pairs = control.triangle_pairs = control.candidates = control.pairs = 0u;
    control.leaf_groups = control.bundle_groups = control.split_groups = control.pair_groups = 0u;
    control.candidate_groups = 0u;
    control.finish_groups = 1u;
    control.neighbour_groups = uint((neighbour_pair_count + GROUP_SIZE - 1) / GROUP_SIZE);
  }
  if (i < vertex_count) {
    position_when_built[i] = FETCH(position, i);
    float speed = length(FETCH(velocity, i).xyz);
    if (speed > 0.0 && speed < 1e30) atomicMax(control.fastest_vertex, floatBitsToUint(speed));
  }
  if (i >= triangle_count) return;
  uvec3 tags = FETCH(surface_triangles, i).xyz;
  for (int k = 0; k < 3; ++k)
    written_corners[3 * i + k] = uvec4(floatBitsToUint(FETCH(position, tags[k] & number_mask).xyz), tags[k]);
}
