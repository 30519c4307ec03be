// The boxes of leaves and bundles that boxes.comp has written, as four texels each.
#include "boxes.glsl"
READ_VEC4(boxes, unit_boxes);

Box box_at(int i) {
  return Box(FETCH(boxes, 4 * i).xyz, FETCH(boxes, 4 * i + 1).xyz, FETCH(boxes, 4 * i + 2).xyz,
             FETCH(boxes, 4 * i + 3).xyz);
}
