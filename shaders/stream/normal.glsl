// Vertex normals: the sum of the cross products of the adjacent faces, so that larger faces count more.
READ_UINT(fan_offsets, unit_fan_offsets);  // [vertex_count + 1] into the fans
READ_UVEC2(fans, unit_fans);  // for each triangle at a vertex its two other corners, counter-clockwise

/// Unit normal at vertex i. If its faces have no area relative to their edges it has no normal: up.
vec3 vertex_normal(int i, vec3 x) {
  vec3 sum = vec3(0.0);
  float scale = 0.0;
  int end = int(FETCH_UINT(fan_offsets, i + 1));
  for (int at = int(FETCH_UINT(fan_offsets, i)); at < end; ++at) {
    uvec2 corners = FETCH_UVEC2(fans, at);
    vec3 a = FETCH(position, corners.x).xyz - x, b = FETCH(position, corners.y).xyz - x;
    sum += cross(a, b);
    scale += dot(a, a) + dot(b, b);
  }
  float area = length(sum);
  return area > 1e-6 * scale ? sum / area : vec3(0.0, 1.0, 0.0);
}
