// How near an iterate may bring what may press.

/// Half of the radius where it begins to press, so that its force then pushes back; a tenth of the gap that it has
/// where it presses. [m]
float kept(float gap, float radius, float rounding) {
  return max(gap < radius ? 0.1 * gap : 0.5 * radius, min(8.0 * rounding, 0.5 * gap));
}
