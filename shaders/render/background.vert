// One triangle that covers the picture.
out float height;  // 0 at the bottom, 1 at the top

void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  height = corner.y;
  gl_Position = vec4(2.0 * corner - 1.0, 1.0, 1.0);
}
