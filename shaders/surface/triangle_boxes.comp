// Pair search, 1 of 10: where all vertices are, and where they will be if they keep their velocities; boxes of the
// triangles; and how fast the fastest vertex is.
#include "surface.glsl"
#include "triangles.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(velocity, unit_velocity);
READ_UVEC4(surface_triangles, unit_surface_triangles);  // w: parts of triangles.glsl, of each corner in turn
layout(std430, binding = slot_triangle_boxes) writeonly buffer TriangleBoxes { uvec4 boxes[]; };  // triangles.glsl
layout(std430, binding = slot_expected) writeonly buffer Expected { vec4 expected[]; };            // expected.glsl

/// How far a vertex goes at its velocity in the time that the search looks ahead [m].
vec3 motion_ahead(uint vertex) {
  vec3 v = FETCH(velocity, vertex).xyz;
  return dot(v, v) < 1e30 ? v * uintBitsToFloat(known.next_ahead) : vec3(0.0);
}

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
    expected[2 * i] = FETCH(position, i);
    expected[2 * i + 1] = vec4(motion_ahead(i), 0.0);
    float speed = length(FETCH(velocity, i).xyz);
    if (speed > 0.0 && speed < 1e30) atomicMax(control.fastest_vertex, floatBitsToUint(speed));
  }
  if (i >= triangle_count) return;
  uvec3 tags = FETCH(surface_triangles, i).xyz;
  vec3 x[3], ahead[3];
  for (int k = 0; k < 3; ++k) {
    uint vertex = tags[k] & number_mask;
    x[k] = FETCH(position, vertex).xyz;
    ahead[k] = x[k] + motion_ahead(vertex);
  }
  Box box = box_of(x, ahead);
  boxes[4 * i] = uvec4(floatBitsToUint(box.low), tags.x);
  boxes[4 * i + 1] = uvec4(floatBitsToUint(box.high), tags.y);
  boxes[4 * i + 2] = uvec4(floatBitsToUint(box.low_ahead), tags.z);
  boxes[4 * i + 3] = uvec4(floatBitsToUint(box.high_ahead), 0u);
}
