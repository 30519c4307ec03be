// The triangles of a search, each as three texels, which corners.comp writes: a corner's place as bits, and its number
// with bits for the parts that the triangle owns.
READ_UVEC4(triangle_corners, unit_triangle_corners);

const uint owns_vertex_bit = 0x80000000u, owns_edge_bit = 0x40000000u;  // the edge from this corner to the next
const uint number_mask = 0x3fffffffu;

struct Triangle {
  vec3 x[3];
  uvec3 tags;  // number and bits of each corner
};

Triangle triangle_at(int i) {
  uvec4 a = FETCH(triangle_corners, 3 * i), b = FETCH(triangle_corners, 3 * i + 1);
  uvec4 c = FETCH(triangle_corners, 3 * i + 2);
  Triangle t;
  t.x = vec3[](uintBitsToFloat(a.xyz), uintBitsToFloat(b.xyz), uintBitsToFloat(c.xyz));
  t.tags = uvec3(a.w, b.w, c.w);
  return t;
}
vec3 low_of(Triangle t) { return min(t.x[0], min(t.x[1], t.x[2])); }
vec3 high_of(Triangle t) { return max(t.x[0], max(t.x[1], t.x[2])); }
