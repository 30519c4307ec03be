// Normal of each vertex: the sum of the cross products of the triangles around it, so that larger triangles weigh more.
layout(local_size_x = 64) in;

layout(std430, binding = 0) readonly buffer Positions { vec4 position[]; };
layout(std430, binding = 1) writeonly buffer Normals { vec4 normal[]; };
layout(std430, binding = 2) readonly buffer Offsets { uint first_triangle[]; };  // [vertex_count + 1]
layout(std430, binding = 3) readonly buffer Around { uint triangle_around[]; };
layout(std430, binding = 4) readonly buffer Triangles { uint corner[]; };  // [triangle_count, 3]
layout(location = 0) uniform uint vertex_count;

void main() {
  uint vertex = gl_GlobalInvocationID.x;
  if (vertex >= vertex_count) return;
  vec3 sum = vec3(0.0);
  for (uint slot = first_triangle[vertex]; slot < first_triangle[vertex + 1]; ++slot) {
    uint first = 3 * triangle_around[slot];
    vec3 a = position[corner[first]].xyz;
    vec3 b = position[corner[first + 1]].xyz;
    vec3 c = position[corner[first + 2]].xyz;
    sum += cross(b - a, c - a);
  }
  // No length at which a normal counts as degenerate: a fine mesh has small sums. Only an exact zero has no direction.
  float largest = max(max(abs(sum.x), abs(sum.y)), abs(sum.z));
  normal[vertex] = vec4(largest > 0.0 ? normalize(sum / largest) : vec3(0.0, 1.0, 0.0), 0.0);
}
