// A vertex's symmetric 3x3 block, stored as L D L^T: a = 1 / D, b = lower triangle of L (21, 31, 32).

/// `corner`: off-diagonal (21, 31, 32). Rounding makes no pivot less than `least`.
void factorise(vec3 diagonal, vec3 corner, float least, out vec3 a, out vec3 b) {
  float l_xy = corner.x / diagonal.x, l_xz = corner.y / diagonal.x;
  float pivot_y = max(diagonal.y - l_xy * corner.x, least);
  float l_yz = (corner.z - l_xz * corner.x) / pivot_y;
  float pivot_z = max(diagonal.z - l_xz * corner.y - l_yz * l_yz * pivot_y, least);
  a = 1.0 / vec3(diagonal.x, pivot_y, pivot_z);
  b = vec3(l_xy, l_xz, l_yz);
}

vec3 block_times(vec3 a, vec3 b, vec3 v) {
  v.x += b.x * v.y + b.y * v.z;
  v.y += b.z * v.z;
  v /= a;
  v.z += b.y * v.x + b.z * v.y;
  v.y += b.x * v.x;
  return v;
}
vec3 solve_block(vec3 a, vec3 b, vec3 r) {
  r.y -= b.x * r.x;
  r.z -= b.y * r.x + b.z * r.y;
  r *= a;
  r.y -= b.z * r.z;
  r.x -= b.x * r.y + b.y * r.z;
  return r;
}
