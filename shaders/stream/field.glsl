// A field's values, and the largest of the present frame and of the one before, from which it falls slowly, so that
// colours do not flicker.
uniform int turn;  // which of `peak` is the present frame's
layout(std430, binding = slot_field) buffer FieldValues {
  uint peak[2];  // the bits of floats
  float values[];
};

const float largest_value = 1e30;

/// The peak, rounded up to a quarter of a power of two: steady, and the same bits on every driver.
float field_range(float least) {
  return max(uintBitsToFloat((peak[turn] + 0x1fffffu) & ~0x1fffffu), least);
}
