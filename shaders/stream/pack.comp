// Frame, 2 of 2: positions and normals as the wire and WebGL take them (server/net/README.md), the box first.
layout(local_size_x = GROUP_SIZE) in;
#include "../access.glsl"
#include "bounds.glsl"

READ_VEC4(position, unit_position);
#include "normal.glsl"
uniform int vertex_count;
#ifdef WITH_FIELD
#include "field.glsl"
uniform float least_range;
#endif
layout(std430, binding = slot_packed) writeonly buffer Packed {
  float packed_box[8];  // minimum, the field's range, extent, unused
  uint packed_vertices[];
};

/// Octahedral normal in [-1, 1]^2: Meyer et al. 2010, Cigolle et al. 2014. The lower half (z < 0) is folded out.
vec2 octahedral(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  return n.z >= 0.0 ? p : (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
}

#ifdef WITH_FIELD
/// Four vertices from number `first` on as bytes over [0, range], after the `words` of all vertices.
void pack_field(int words, int first) {
  float range = field_range(least_range);
  if (first == 0) packed_box[3] = range;
  uint bytes = 0u;
  for (int k = 0; k < 4 && first + k < vertex_count; ++k)
    bytes |= uint(min(values[first + k] / range, 1.0) * 255.0 + 0.5) << 8 * k;
  packed_vertices[words + first / 4] = bytes;
}
#endif

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec3 low = box_minimum();
  vec3 extent = max(box_maximum() - low, vec3(0.0));
  if (i == 0) {
    for (int axis = 0; axis < 3; ++axis) {
      packed_box[axis] = low[axis];
      packed_box[4 + axis] = extent[axis];
    }
  }
  if (i >= vertex_count) return;
  vec3 x = FETCH(position, i).xyz;
  vec3 n = vertex_normal(i, x);
#ifdef ENCODING_F32
  int at = 6 * i;
  for (int axis = 0; axis < 3; ++axis) {
    packed_vertices[at + axis] = floatBitsToUint(x[axis]);
    packed_vertices[at + 3 + axis] = floatBitsToUint(n[axis]);
  }
#elif defined(ENCODING_Q16)
  vec3 share = clamp((x - low) / max(extent, vec3(1e-30)), vec3(0.0), vec3(1.0));
  uvec3 u = uvec3(share * 65535.0 + 0.5);
  ivec2 o = ivec2(round(octahedral(n) * 127.0));
  packed_vertices[2 * i] = u.x | u.y << 16;
  packed_vertices[2 * i + 1] = u.z | uint(o.x & 255) << 16 | uint(o.y & 255) << 24;
#else
#error this encoding has no branch in pack.comp
#endif
#ifdef WITH_FIELD
  if (i % 4 == 0) pack_field(WORDS * vertex_count, i);
#endif
}
