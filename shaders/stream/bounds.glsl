// The box of all vertices, gathered with integer atomics. Floats are mapped to unsigned integers of the same order; a
// minimum does not depend on the order in which its values came.
layout(std430, binding = slot_bounds) buffer Bounds { uint box_low[4], box_high[4]; };

uint ordered(float x) {
  uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}
float unordered(uint key) {
  return uintBitsToFloat((key & 0x80000000u) != 0 ? key & 0x7fffffffu : ~key);
}
vec3 box_minimum() { return vec3(unordered(box_low[0]), unordered(box_low[1]), unordered(box_low[2])); }
vec3 box_maximum() { return vec3(unordered(box_high[0]), unordered(box_high[1]), unordered(box_high[2])); }
