// Pair search, 1 of 6: boxes of triangles, the largest of them and the fastest vertex; notes where each vertex is.
#include "surface.glsl"
READ_VEC4(position, unit_position);
READ_VEC4(velocity, unit_velocity);
READ_UVEC4(surface_triangles, unit_surface_triangles);
// middle, half the longest side; half of each side
layout(std430, binding = slot_triangle_boxes) writeonly buffer Boxes { vec4 boxes[]; };
layout(std430, binding = slot_surface_built) writeonly buffer Built { vec4 position_when_built[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i == 0) triangle_pairs = candidates = pairs = split_groups = candidate_groups = pair_groups = 0u;
  if (i < vertex_count) {
    position_when_built[i] = FETCH(position, i);
    float speed = length(FETCH(velocity, i).xyz);
    if (speed > uintBitsToFloat(fastest_vertex) && speed < 1e30) atomicMax(fastest_vertex, floatBitsToUint(speed));
  }
  if (i >= triangle_count) return;
  uvec4 corners = FETCH(surface_triangles, i);
  vec3 a = FETCH(position, corners.x).xyz, b = FETCH(position, corners.y).xyz, c = FETCH(position, corners.z).xyz;
  vec3 low = min(a, min(b, c)), high = max(a, max(b, c)), half_sides = 0.5 * (high - low);
  float radius = max(half_sides.x, max(half_sides.y, half_sides.z));
  if (radius > uintBitsToFloat(largest_triangle) && radius < 1e30)
    atomicMax(largest_triangle, floatBitsToUint(radius));
  boxes[2 * i] = vec4(0.5 * (low + high), radius);
  boxes[2 * i + 1] = vec4(half_sides, 0.0);
}
