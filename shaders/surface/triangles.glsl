// The triangles of a search, each as four texels, which triangle_boxes.comp writes: its box, as bits, and in w the
// number of each corner, with bits for the parts that the triangle owns.
#include "boxes.glsl"
READ_UVEC4(triangle_boxes, unit_triangle_boxes);

const uint owns_vertex_bit = 0x80000000u, owns_edge_bit = 0x40000000u;  // the edge from this corner to the next
const uint number_mask = 0x3fffffffu;

struct Triangle {
  Box box;
  uvec3 tags;  // number and bits of each corner
};

Triangle triangle_at(int i) {
  uvec4 low = FETCH(triangle_boxes, 4 * i), high = FETCH(triangle_boxes, 4 * i + 1);
  uvec4 low_ahead = FETCH(triangle_boxes, 4 * i + 2), high_ahead = FETCH(triangle_boxes, 4 * i + 3);
  return Triangle(Box(uintBitsToFloat(low.xyz), uintBitsToFloat(high.xyz), uintBitsToFloat(low_ahead.xyz),
                      uintBitsToFloat(high_ahead.xyz)),
                  uvec3(low.w, high.w, low_ahead.w));
}
