/// Leaves of LEAF_SIZE triangles each: their boxes come first in the list of boxes, those of bundles after them.
int leaf_count() { return (triangle_count + LEAF_SIZE - 1) / LEAF_SIZE; }

/// The square of the distance between two boxes, along any direction [m^2]. In a sheet that lies askew to the axes half
/// as many are near as by the largest gap along an axis.
float box_gap_squared(vec3 low, vec3 high, vec3 other_low, vec3 other_high) {
  vec3 gaps = max(max(other_low - high, low - other_high), 0.0);
  return dot(gaps, gaps);
}
