// Cloth has two sides: every triangle is drawn as it is, and again turned over with its normals reversed. Culling back
// faces then leaves the one that looks at the eye, lit by its own normal.
layout(triangles) in;
layout(triangle_strip, max_vertices = 6) out;

in Corner {
  vec3 position;
  vec3 normal;
  vec2 texture_coordinate;
} corner[];

out Surface {
  vec3 position;
  vec3 normal;
  vec2 texture_coordinate;
} surface;
flat out float back;  // 1 on the back side

void emit(int index, float side) {
  surface.position = corner[index].position;
  surface.normal = side * corner[index].normal;
  surface.texture_coordinate = corner[index].texture_coordinate;
  back = side < 0.0 ? 1.0 : 0.0;
  gl_Position = gl_in[index].gl_Position;
  EmitVertex();
}

void main() {
  for (int index = 0; index < 3; ++index) emit(index, 1.0);
  EndPrimitive();
  for (int index = 2; index >= 0; --index) emit(index, -1.0);
  EndPrimitive();
}
