/// Leaves of LEAF_SIZE triangles each: their boxes come first in the list of boxes, those of bundles after them.
int leaf_count() { return (triangle_count + LEAF_SIZE - 1) / LEAF_SIZE; }
int bundle_count() { return (triangle_count + BUNDLE_SIZE - 1) / BUNDLE_SIZE; }

/// Of a large mesh the boxes of boughs come last, of BOUGH_SIZE leaves in turn: leaf by leaf the search for near ones
/// would take the square of their number.
bool has_boughs() { return leaf_count() > 4 * BOUGH_SIZE; }
int bough_count() { return has_boughs() ? (leaf_count() + BOUGH_SIZE - 1) / BOUGH_SIZE : 0; }

/// About something where it is at the search, and where it will be, as far ahead as the search looks, if it keeps its
/// velocity [m].
struct Box {
  vec3 low, high, low_ahead, high_ahead;
};

Box box_of(vec3 x[3], vec3 ahead[3]) {
  return Box(min(x[0], min(x[1], x[2])), max(x[0], max(x[1], x[2])), min(ahead[0], min(ahead[1], ahead[2])),
             max(ahead[0], max(ahead[1], ahead[2])));
}

/// The square of the distance that two boxes keep all the way, along any direction [m^2]. Along an axis the gap between
/// what moves straight on is never less than the lesser of those at both ends. In a sheet that lies askew to the axes
/// half as many are near as by the largest gap along an axis.
float box_gap_squared(Box one, Box other) {
  vec3 above = min(other.low - one.high, other.low_ahead - one.high_ahead);
  vec3 below = min(one.low - other.high, one.low_ahead - other.high_ahead);
  vec3 gaps = max(max(above, below), 0.0);
  return dot(gaps, gaps);
}
