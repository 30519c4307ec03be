/// Integers in which the filter's impulses are summed [1/(m/s)]: a vertex that goes as far in this piece as the listed
/// pairs allow has half of 2^26.
float units_of_speed() {
  return 67108864.0 * dt * uintBitsToFloat(known.part) / uintBitsToFloat(known.query);
}

/// A change of a vertex's velocity [m/s], of which each of so many pairs gives its share. As no more pairs than
/// `sharers` give one to a vertex, their sum is at most 2^30 and what rounding adds, half a unit for each.
ivec3 in_units_of_speed(vec3 change, float sharers) {
  const vec3 most = vec3(1073741824.0);
  return ivec3(round(clamp(change * units_of_speed(), -most, most) / sharers));
}
